% SPDX-License-Identifier: BSD-3-Clause
function r = cbrt(a)
% Cubic root, element by element.
r = sign(a) .* abs(a) .^ (1 / 3);
end
