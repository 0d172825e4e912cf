% SPDX-License-Identifier: BSD-3-Clause
function r = tan(a)
% Tangent, element by element.
r = applied('tan', a);
end
