% SPDX-License-Identifier: BSD-3-Clause
function r = columns(a)
% Number of columns.
r = size(a.id, 2);
end
