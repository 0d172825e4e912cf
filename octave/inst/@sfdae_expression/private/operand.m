% SPDX-License-Identifier: BSD-3-Clause
function r = operand(a)
% Nodes of an expression, or real numbers of class double, as sfdae_mex takes them.
if isa(a, 'sfdae_expression')
  r = a.id;
elseif isnumeric(a) || islogical(a)
  if ~isreal(a)
    error('sfdae:illegal_argument', ['expressions are real: they cannot be combined with complex numbers; ' ...
          'write equations for real and imaginary parts']);
  end
  r = full(double(a));
else
  error('sfdae:illegal_argument', ...
        'expressions can be combined with expressions and numbers, not with a value of class %s', class(a));
end
end
