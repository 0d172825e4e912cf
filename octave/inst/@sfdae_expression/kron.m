% SPDX-License-Identifier: BSD-3-Clause
function r = kron(a, b)
% Kronecker product of two matrices.
a = operand(a);
b = operand(b);
[i, j] = meshgrid(1:size(a, 2), 1:size(a, 1));
places = sub2ind(size(a), kron(j, ones(size(b))), kron(i, ones(size(b))));
r = sfdae_expression(sfdae_mex('multiply', reshape(a(places), size(places)), repmat(b, size(a))));
end
