% SPDX-License-Identifier: BSD-3-Clause
function r = binary(operation, a, b)
% The expression that an operation of two operands makes, element by element. One operand at least is an expression,
% which is reused for the result: the constructor takes longer.
if ~isa(a, 'sfdae_expression')
  r = b;
  r.id = sfdae_mex(operation, operand(a), b.id);
elseif isa(b, 'sfdae_expression')
  r = a;
  r.id = sfdae_mex(operation, a.id, b.id);
else
  r = a;
  r.id = sfdae_mex(operation, a.id, operand(b));
end
r.is_condition = false;
end
