% SPDX-License-Identifier: BSD-3-Clause
function [r, place] = max(a, b, dim)
% The largest of two values, element by element, or of the rows or columns of an expression.
if nargout > 1
  unsupported('the position of the largest element', 'use the value alone');
end
if nargin >= 2 && ~isempty(b)
  r = applied('max', a, b);
else
  if nargin < 3
    dim = [];
  end
  r = reduced('max', a, dim, 0);
end
end
