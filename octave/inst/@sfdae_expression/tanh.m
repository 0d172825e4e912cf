% SPDX-License-Identifier: BSD-3-Clause
function r = tanh(a)
% Hyperbolic tangent, element by element.
r = applied('tanh', a);
end
