% SPDX-License-Identifier: BSD-3-Clause
function r = fix(a)
% Integer part, element by element.
r = ifelse(a > 0, floor(a), -floor(-a));
end
