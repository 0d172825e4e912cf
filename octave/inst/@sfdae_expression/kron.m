% SPDX-License-Identifier: BSD-3-Clause
function r = kron(a, b)
% Kronecker product of two matrices.
a = operand(a);
b = operand(b);
[i, j] = meshgrid(1:size(a, 2), 1:size(a, 1));
rows = kron(j, ones(size(b)));
columns = kron(i, ones(size(b)));
r = applied('multiply', spread(a, rows, columns), repmat(b, size(a)));
end

function r = spread(a, rows, columns)
r = a(sub2ind(size(a), rows, columns));
if isa(a, 'int64')
  r = sfdae_expression(r);
end
end
