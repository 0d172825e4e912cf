% SPDX-License-Identifier: BSD-3-Clause
function r = ceil(a)
% Smallest integer from a on, element by element.
r = -floor(-a);
end
