% SPDX-License-Identifier: BSD-3-Clause
function r = acosh(a)
% Inverse hyperbolic cosine, element by element.
r = log(a + sqrt(a .* a - 1));
end
