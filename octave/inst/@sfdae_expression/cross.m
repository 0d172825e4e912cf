% SPDX-License-Identifier: BSD-3-Clause
function r = cross(a, b)
% Vector product of two vectors of three elements; the size is that of a.
if numel(a) ~= 3 || numel(b) ~= 3
  error('sfdae:illegal_argument', 'cross: two vectors of 3 elements are needed, not of sizes %s and %s', ...
        mat2str(size(a)), mat2str(size(b)));
end
% Within methods a(2) is an element of the array of objects, so the nodes are indexed.
shape = size(a);
a = operand(a);
b = operand(b);
a = a(:);
b = b(:);
first = sfdae_mex('multiply', a([2 3 1]), b([3 1 2]));
second = sfdae_mex('multiply', a([3 1 2]), b([2 3 1]));
r = sfdae_expression(reshape(sfdae_mex('subtract', first, second), shape));
end
