% SPDX-License-Identifier: BSD-3-Clause
function system = checked_system(caller, system)
% A struct with full matrices E, A, B, C, D of sizes that agree.
if ~isstruct(system) || ~isscalar(system) || ~isfield(system, 'E') || ~isfield(system, 'A')
  error('sfdae:illegal_argument', '%s: the system has to be a struct with the fields E and A', caller);
end
[m, n] = size(system.E);
for name = {'B', 'C', 'D'}
  if ~isfield(system, name{1})
    system.(name{1}) = [];
  end
end
q = size(system.B, 2);
p = size(system.C, 1);
expected = struct('E', [m n], 'A', [m n], 'B', [m q], 'C', [p n], 'D', [p q]);
for name = {'E', 'A', 'B', 'C', 'D'}
  value = system.(name{1});
  if ~(isnumeric(value) && isreal(value) && ndims(value) == 2 && all(isfinite(value(:))))
    error('sfdae:illegal_argument', '%s: %s has to be a matrix of finite real numbers', caller, name{1});
  end
  if ~isequal(size(value), expected.(name{1})) && ~(isempty(value) && ~any(strcmp(name{1}, {'E', 'A'})))
    error('sfdae:illegal_argument', '%s: %s has size %s; it has to be %s', caller, name{1}, mat2str(size(value)), ...
          mat2str(expected.(name{1})));
  end
  system.(name{1}) = full(double(value));
end
end
