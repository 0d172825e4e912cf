% SPDX-License-Identifier: BSD-3-Clause
function r = diff(a, order, dim)
% Differences of neighboring elements.
if nargin < 2 || isempty(order)
  order = 1;
end
if nargin < 3
  dim = [];
end
dim = along(a.id, dim);
ids = a.id;
for k = 1:order
  if dim == 1
    ids = sfdae_mex('subtract', ids(2:end, :), ids(1:end - 1, :));
  else
    ids = sfdae_mex('subtract', ids(:, 2:end), ids(:, 1:end - 1));
  end
end
r = sfdae_expression(ids);
end
