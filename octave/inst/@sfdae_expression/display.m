% SPDX-License-Identifier: BSD-3-Clause
function display(a)
% Shows the size of an expression.
fprintf('%s = <%d x %d formulas, being recorded>\n', inputname(1), size(a.id, 1), size(a.id, 2));
end
