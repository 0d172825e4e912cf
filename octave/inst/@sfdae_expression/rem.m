% SPDX-License-Identifier: BSD-3-Clause
function r = rem(a, b)
% Remainder with the sign of a, element by element.
quotient = a ./ b;
r = a - b .* ifelse(quotient > 0, floor(quotient), -floor(-quotient));
end
