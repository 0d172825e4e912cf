% SPDX-License-Identifier: BSD-3-Clause
function r = gt(a, b)
% a > b, element by element.
r = binary('greater', a, b);
r.is_condition = true;
end
