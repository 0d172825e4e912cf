% SPDX-License-Identifier: BSD-3-Clause
function r = cumsum(a, dim)
% Cumulative sum along the rows (dim = 1) or columns (dim = 2).
if nargin < 2
  dim = [];
end
if along(a.id, dim) == 1
  r = tril(ones(size(a.id, 1))) * a;
else
  r = a * triu(ones(size(a.id, 2)));
end
end
