% SPDX-License-Identifier: BSD-3-Clause
function r = sum(a, dim)
% Sum of the rows (dim = 1) or columns (dim = 2).
if nargin < 2
  dim = [];
end
ids = operand(a);
if along(ids, dim) == 1
  r = sfdae_expression(sfdae_mex('mtimes', ones(1, size(ids, 1)), ids));
else
  r = sfdae_expression(sfdae_mex('mtimes', ids, ones(size(ids, 2), 1)));
end
end
