% SPDX-License-Identifier: BSD-3-Clause
function r = lt(a, b)
% a < b, element by element.
r = binary('less', a, b);
r.is_condition = true;
end
