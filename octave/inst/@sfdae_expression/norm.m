% SPDX-License-Identifier: BSD-3-Clause
function r = norm(a, p)
% Norm of a vector: p = 1, 2 (default), Inf or 'fro'.
if nargin < 2
  p = 2;
end
if min(size(a.id)) > 1 && ~isequal(p, 'fro')
  unsupported('the norm of a matrix of expressions', 'use the norm ''fro'' or norms of vectors');
end
if isequal(p, 2) || isequal(p, 'fro')
  r = sqrt(sum(vec(a) .* vec(a)));
elseif isequal(p, 1)
  r = sum(abs(vec(a)));
elseif isequal(p, Inf) || isequal(p, 'inf')
  r = max(abs(vec(a)));
else
  error('sfdae:illegal_argument', 'norm: p has to be 1, 2, Inf or ''fro''');
end
end
