% SPDX-License-Identifier: BSD-3-Clause
function r = mtimes(a, b)
% a * b: product of matrices; zeros of a matrix of numbers make no term.
a = operand(a);
b = operand(b);
if isscalar(a) || isscalar(b)
  r = sfdae_expression(sfdae_mex('multiply', a, b));
else
  r = sfdae_expression(sfdae_mex('mtimes', a, b));
end
end
