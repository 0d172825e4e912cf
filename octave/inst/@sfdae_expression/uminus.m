% SPDX-License-Identifier: BSD-3-Clause
function r = uminus(a)
% -a, element by element.
r = applied('negate', a);
end
