% SPDX-License-Identifier: BSD-3-Clause
function r = power(a, b)
% a .^ b, element by element.
r = binary('power', a, b);
end
