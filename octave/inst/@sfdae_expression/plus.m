% SPDX-License-Identifier: BSD-3-Clause
function r = plus(a, b)
% a + b, element by element.
r = binary('add', a, b);
end
