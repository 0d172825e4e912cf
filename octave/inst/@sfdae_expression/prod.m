% SPDX-License-Identifier: BSD-3-Clause
function r = prod(a, dim)
% Product of the rows (dim = 1) or columns (dim = 2).
if nargin < 2
  dim = [];
end
r = reduced('multiply', a, dim, 1);
end
