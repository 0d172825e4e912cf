% SPDX-License-Identifier: BSD-3-Clause
function r = abs(a)
% Absolute value, element by element.
r = applied('abs', a);
end
