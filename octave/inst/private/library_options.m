% SPDX-License-Identifier: BSD-3-Clause
function o = library_options(options, n)
% The options of the library, for a problem of n unknowns, as sfdae_mex takes them.
[names, kinds] = option_names();
o = struct();
given = fieldnames(options);
of_library = names(1:numel(kinds));
for k = 1:numel(given)
  if any(strcmp(of_library, given{k}))
    o.(given{k}) = options.(given{k});
  end
end
for name = {'rtol', 'atol'}
  if isfield(o, name{1}) && ~isscalar(o.(name{1}))
    need_count(name{1}, o.(name{1}), n);
    o.([name{1} '_vector']) = o.(name{1})(:);
    o = rmfield(o, name{1});
  end
end
if isfield(o, 'initial_weights')
  need_count('initial_weights', o.initial_weights, n);
end
if isfield(o, 'fixed')
  o.fixed = flags(o.fixed, n, 'fixed');
  if ~isfield(o, 'initial_values')
    o.initial_values = 'fixed';
  end
end
end

function need_count(name, value, n)
if numel(value) ~= n
  error('sfdae:illegal_argument', 'the option %s has %d elements; there are %d unknowns', name, numel(value), n);
end
end
