% SPDX-License-Identifier: BSD-3-Clause
function r = rdivide(a, b)
% a ./ b, element by element.
r = binary('divide', a, b);
end
