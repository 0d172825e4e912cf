% SPDX-License-Identifier: BSD-3-Clause
function r = deg2rad(a)
% Degrees in radians, element by element.
r = a * (pi / 180);
end
