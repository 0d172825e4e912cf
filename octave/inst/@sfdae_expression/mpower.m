% SPDX-License-Identifier: BSD-3-Clause
function r = mpower(a, b)
% a ^ b: scalars, or a square matrix to a whole power.
if numel(operand(a)) == 1 && numel(operand(b)) == 1
  r = binary('power', a, b);
elseif isa(a, 'sfdae_expression') && isnumeric(b) && ~isa(b, 'sfdae_expression') && isscalar(b) && ...
       b == floor(b) && b >= 1 && size(a, 1) == size(a, 2)
  r = a;
  for k = 2:b
    r = r * a;
  end
else
  error('sfdae:illegal_argument', ...
        'a ^ b needs scalars, or a square matrix and a whole power; write a .^ b for powers of elements');
end
end
