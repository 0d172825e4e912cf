% SPDX-License-Identifier: BSD-3-Clause
function r = real(a)
% Real part: the expression itself, element by element.
r = a;
end
