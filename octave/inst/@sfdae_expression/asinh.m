% SPDX-License-Identifier: BSD-3-Clause
function r = asinh(a)
% Inverse hyperbolic sine, element by element.
root = sqrt(a .* a + 1);
r = ifelse(a > 0, log(root + a), -log(root - a));
end
