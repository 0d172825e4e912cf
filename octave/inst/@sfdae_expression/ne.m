% SPDX-License-Identifier: BSD-3-Clause
function r = ne(a, b)
% a ~= b is refused: the solution violates such a condition at single points only.
unsupported('a ~= b of expressions', 'write ifelse(abs(a - b) > tolerance, ...)');
r = [];
end
