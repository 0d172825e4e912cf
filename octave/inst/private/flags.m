% SPDX-License-Identifier: BSD-3-Clause
function f = flags(value, n, name)
% n flags, 1 or 0, from numbers of unknowns or from true and false for each of them.
if islogical(value)
  if numel(value) ~= n
    error('sfdae:illegal_argument', '%s has %d flags; there are %d unknowns', name, numel(value), n);
  end
  f = double(value(:));
else
  if any(value(:) < 1 | value(:) > n | value(:) ~= floor(value(:)))
    error('sfdae:illegal_argument', '%s has to contain numbers of unknowns, 1 to %d', name, n);
  end
  f = zeros(n, 1);
  f(value) = 1;
end
end
