% SPDX-License-Identifier: BSD-3-Clause
function r = isvector(a)
% True for a row or a column.
r = isvector(a.id);
end
