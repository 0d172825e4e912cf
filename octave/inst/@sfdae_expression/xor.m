% SPDX-License-Identifier: BSD-3-Clause
function r = xor(a, b)
% Exclusive or, element by element; true means not 0.
r = (a | b) & ~(a & b);
end
