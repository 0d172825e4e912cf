% SPDX-License-Identifier: BSD-3-Clause
function r = round(a)
% Nearest integer, element by element.
r = ifelse(a > 0, floor(a + 0.5), -floor(0.5 - a));
end
