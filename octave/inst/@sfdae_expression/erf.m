% SPDX-License-Identifier: BSD-3-Clause
function r = erf(a)
% Error function, element by element.
r = applied('erf', a);
end
