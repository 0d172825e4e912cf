% SPDX-License-Identifier: BSD-3-Clause
function r = flipud(a)
% Rows in reverse order.
a.id = a.id(end:-1:1, :);
r = a;
end
