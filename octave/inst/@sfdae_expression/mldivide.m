% SPDX-License-Identifier: BSD-3-Clause
function r = mldivide(a, b)
% a \ b for a scalar a or a matrix a of numbers.
if isscalar(a)
  r = applied('divide', b, a);
elseif isa(a, 'sfdae_expression')
  unsupported('division by a matrix of expressions', 'make the solution z unknowns with the equations a * z - b');
else
  r = (a \ eye(size(a, 1))) * b;
end
end
