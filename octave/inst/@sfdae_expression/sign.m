% SPDX-License-Identifier: BSD-3-Clause
function r = sign(a)
% Sign, -1, 0 or 1, element by element.
r = applied('sign', a);
end
