% SPDX-License-Identifier: BSD-3-Clause
function r = plus(a, b)
% a + b, element by element.
r = applied('add', a, b);
end
