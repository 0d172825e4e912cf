% SPDX-License-Identifier: BSD-3-Clause
function r = mtimes(a, b)
% a * b: product of matrices; zeros of a matrix of numbers make no term.
if isa(a, 'sfdae_expression')
  r = a;     % reused: the constructor takes longer
  a = r.id;
  b = operand(b);
else
  r = b;
  b = r.id;
  a = operand(a);
end
if numel(a) == 1 || numel(b) == 1
  r.id = sfdae_mex('multiply', a, b);
else
  r.id = sfdae_mex('mtimes', a, b);
end
r.is_condition = false;
end
