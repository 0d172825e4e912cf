% SPDX-License-Identifier: BSD-3-Clause
function r = erfc(a)
% Complementary error function, element by element.
r = applied('erfc', a);
end
