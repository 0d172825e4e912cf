% SPDX-License-Identifier: BSD-3-Clause
function r = sqrt(a)
% Square root, element by element.
r = applied('sqrt', a);
end
