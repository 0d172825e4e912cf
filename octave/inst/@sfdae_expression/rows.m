% SPDX-License-Identifier: BSD-3-Clause
function r = rows(a)
% Number of rows.
r = size(a.id, 1);
end
