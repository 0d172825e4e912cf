% SPDX-License-Identifier: BSD-3-Clause
function problem = properties_of(caller, names, pairs)
% A struct of the properties that pairs of names and values give; an error for other names.
problem = struct();
if mod(numel(pairs), 2) ~= 0
  error('sfdae:illegal_argument', '%s: names and values have to come in pairs', caller);
end
for k = 1:2:numel(pairs)
  if ~ischar(pairs{k}) || ~any(strcmp(pairs{k}, names))
    shown = 'a name is no text';
    if ischar(pairs{k})
      shown = sprintf('there is no property ''%s''', pairs{k});
    end
    error('sfdae:illegal_argument', '%s: %s; there are %s', caller, shown, strjoin(names, ', '));
  end
  problem.(pairs{k}) = pairs{k + 1};
end
end
