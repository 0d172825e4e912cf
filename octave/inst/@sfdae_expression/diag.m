% SPDX-License-Identifier: BSD-3-Clause
function r = diag(a)
% The diagonal of a matrix, or the diagonal matrix of a vector.
ids = a.id;
if min(size(ids)) == 1
  r = sfdae_expression(sfdae_mex('nodes', zeros(numel(ids))));
  r.id(1:numel(ids) + 1:end) = ids(:);
else
  r = sfdae_expression(ids(1:size(ids, 1) + 1:size(ids, 1) * min(size(ids))).');
end
end
