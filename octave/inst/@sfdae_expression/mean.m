% SPDX-License-Identifier: BSD-3-Clause
function r = mean(a, dim)
% Mean of the rows (dim = 1) or columns (dim = 2).
if nargin < 2
  dim = [];
end
dim = along(a.id, dim);
r = sum(a, dim) / size(a.id, dim);
end
