% SPDX-License-Identifier: BSD-3-Clause
function r = vec(a)
% All elements as a column.
a.id = a.id(:);
r = a;
end
