% SPDX-License-Identifier: BSD-3-Clause
function options = given_options(name, given)
% Options from the last arguments of a function: none, a struct, or a struct and pairs of names and values.
if isempty(given)
  options = struct();
elseif numel(given) == 1 && isempty(given{1})
  options = struct();
elseif numel(given) == 1 && ~isstruct(given{1})
  error('sfdae:illegal_argument', '%s: options have to be a struct, as sfdae_options returns it, not of class %s', ...
        name, class(given{1}));
else
  options = sfdae_options(given{:});
end
end
