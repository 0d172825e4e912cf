% SPDX-License-Identifier: BSD-3-Clause
function name = option_name(given)
% The name of an option, whatever its capitals; names of odeset are translated. An error names the most similar one.
names = option_names();
if any(strcmp(names, given))
  name = given;
  return
end
of_odeset = {'RelTol', 'rtol'; 'AbsTol', 'atol'; 'MaxStep', 'max_step'; 'InitialStep', 'initial_step'; ...
             'MaxOrder', 'max_order'; 'Events', 'events'; 'Jacobian', 'jacobian'};
translated = strcmpi(of_odeset(:, 1), given);
if any(translated)
  name = of_odeset{translated, 2};
  return
end
found = strcmpi(names, given);
if any(found)
  name = names{found};
  return
end
distances = cellfun(@(n) distance_of(lower(given), n), names);
[smallest, k] = min(distances);
hint = 'sfdae_options() shows all names';
if smallest <= 3
  hint = sprintf('do you mean %s?', names{k});
end
error('sfdae:illegal_argument', 'there is no option ''%s'': %s', given, hint);
end

function d = distance_of(a, b)
% Number of letters to insert, delete or replace (Levenshtein).
d = 0:numel(b);
for i = 1:numel(a)
  before = d;
  d(1) = i;
  for j = 1:numel(b)
    d(j + 1) = min([before(j + 1) + 1, d(j) + 1, before(j) + (a(i) ~= b(j))]);
  end
end
d = d(end);
end
