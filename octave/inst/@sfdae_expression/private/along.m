% SPDX-License-Identifier: BSD-3-Clause
function dim = along(ids, dim)
% The dimension along which functions such as sum work: the given one, or the first one that is not 1.
if isempty(dim)
  dim = 1 + (size(ids, 1) == 1);
elseif ~(isnumeric(dim) && isscalar(dim) && (dim == 1 || dim == 2))
  error('sfdae:illegal_argument', 'the dimension has to be 1 or 2: expressions are scalars, vectors or matrices');
else
  dim = double(dim);
end
end
