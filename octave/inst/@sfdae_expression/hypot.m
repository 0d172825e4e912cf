% SPDX-License-Identifier: BSD-3-Clause
function r = hypot(a, b)
% sqrt(a^2 + b^2), element by element.
r = sqrt(a .* a + b .* b);
end
