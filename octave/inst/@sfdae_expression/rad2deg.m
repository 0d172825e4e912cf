% SPDX-License-Identifier: BSD-3-Clause
function r = rad2deg(a)
% Radians in degrees, element by element.
r = a * (180 / pi);
end
