% SPDX-License-Identifier: BSD-3-Clause
function r = le(a, b)
% a <= b, element by element.
r = binary('less_equal', a, b);
r.is_condition = true;
end
