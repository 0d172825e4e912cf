% SPDX-License-Identifier: BSD-3-Clause
function r = mrdivide(a, b)
% a / b for a scalar b or a matrix b of numbers.
if isscalar(b)
  r = applied('divide', a, b);
elseif isa(b, 'sfdae_expression')
  unsupported('division by a matrix of expressions', 'make the quotient z an unknown with the equations z * b - a');
else
  r = a * (eye(size(b, 2)) / b);
end
end
