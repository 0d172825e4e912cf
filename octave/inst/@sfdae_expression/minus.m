% SPDX-License-Identifier: BSD-3-Clause
function r = minus(a, b)
% a - b, element by element.
r = binary('subtract', a, b);
end
