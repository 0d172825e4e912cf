% SPDX-License-Identifier: BSD-3-Clause
function r = atan(a)
% Inverse tangent, element by element.
r = applied('atan', a);
end
