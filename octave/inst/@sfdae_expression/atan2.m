% SPDX-License-Identifier: BSD-3-Clause
function r = atan2(a, b)
% Angle of the point (b, a), element by element.
r = applied('atan2', a, b);
end
