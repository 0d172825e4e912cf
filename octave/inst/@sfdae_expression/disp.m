% SPDX-License-Identifier: BSD-3-Clause
function disp(a)
% Shows the size of an expression.
fprintf('<%d x %d formulas, being recorded>\n', size(a.id, 1), size(a.id, 2));
end
