% SPDX-License-Identifier: BSD-3-Clause
function r = reduced(operation, a, dim, empty)
% Combines the rows (dim = 1) or the columns (dim = 2) of an expression by an operation of two operands.
ids = operand(a);
dim = along(ids, dim);
if dim == 2
  ids = ids.';
end
if isempty(ids)
  r = sfdae_expression(sfdae_mex('nodes', empty * ones(1, size(ids, 2))));
else
  value = ids(1, :);
  for k = 2:size(ids, 1)
    value = sfdae_mex(operation, value, ids(k, :));
  end
  r = sfdae_expression(value);
end
if dim == 2
  r = r.';
end
end
