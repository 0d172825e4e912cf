% SPDX-License-Identifier: BSD-3-Clause
function r = eq(a, b)
% a == b is refused: the solution meets such a condition at single points only.
unsupported('a == b of expressions', 'write ifelse(abs(a - b) < tolerance, ...)');
r = [];
end
