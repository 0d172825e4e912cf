% SPDX-License-Identifier: BSD-3-Clause
function r = dot(a, b)
% Sum of the products of the elements of two vectors.
if numel(a) ~= numel(b) || min(size(a)) ~= 1 || min(size(b)) ~= 1
  error('sfdae:illegal_argument', 'dot: two vectors of the same length are needed, not of sizes %s and %s', ...
        mat2str(size(a)), mat2str(size(b)));
end
r = sfdae_expression(sfdae_mex('mtimes', reshape(operand(a), 1, []), reshape(operand(b), [], 1)));
end
