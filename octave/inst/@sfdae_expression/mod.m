% SPDX-License-Identifier: BSD-3-Clause
function r = mod(a, b)
% Remainder with the sign of b, element by element.
r = binary('modulo', a, b);
end
