% SPDX-License-Identifier: BSD-3-Clause
function r = atanh(a)
% Inverse hyperbolic tangent, element by element.
r = log((1 + a) ./ (1 - a)) / 2;
end
