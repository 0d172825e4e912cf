% SPDX-License-Identifier: BSD-3-Clause
function r = times(a, b)
% a .* b, element by element.
r = binary('multiply', a, b);
end
