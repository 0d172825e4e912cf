% SPDX-License-Identifier: BSD-3-Clause
function r = fliplr(a)
% Columns in reverse order.
a.id = a.id(:, end:-1:1);
r = a;
end
