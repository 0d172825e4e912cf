% SPDX-License-Identifier: BSD-3-Clause
function r = sin(a)
% Sine, element by element.
r = applied('sin', a);
end
