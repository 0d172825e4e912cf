% SPDX-License-Identifier: BSD-3-Clause
function r = sinh(a)
% Hyperbolic sine, element by element.
r = applied('sinh', a);
end
