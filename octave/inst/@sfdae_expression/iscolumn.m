% SPDX-License-Identifier: BSD-3-Clause
function r = iscolumn(a)
% True for a column.
r = iscolumn(a.id);
end
