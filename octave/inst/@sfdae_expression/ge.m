% SPDX-License-Identifier: BSD-3-Clause
function r = ge(a, b)
% a >= b, element by element.
r = binary('greater_equal', a, b);
r.is_condition = true;
end
