% SPDX-License-Identifier: BSD-3-Clause
function r = ldivide(a, b)
% a .\ b, element by element.
r = applied('divide', b, a);
end
