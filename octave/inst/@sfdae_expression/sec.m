% SPDX-License-Identifier: BSD-3-Clause
function r = sec(a)
% Secant, element by element.
r = 1 ./ cos(a);
end
