% SPDX-License-Identifier: BSD-3-Clause
function r = cosh(a)
% Hyperbolic cosine, element by element.
r = applied('cosh', a);
end
