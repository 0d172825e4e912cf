% SPDX-License-Identifier: BSD-3-Clause
function r = le(a, b)
% a <= b, element by element.
r = applied('less_equal', a, b);
r.is_condition = true;
end
