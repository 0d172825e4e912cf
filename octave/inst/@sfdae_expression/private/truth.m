% SPDX-License-Identifier: BSD-3-Clause
function r = truth(a)
% 1 if a is not 0, else 0: a comparison is 1 or 0, and so is what & | ~ make.
if ~isa(a, 'sfdae_expression')
  r = double(operand(a) ~= 0);
elseif a.is_condition
  r = a;
else
  r = applied('or', applied('less', a, 0), applied('greater', a, 0));
end
end
