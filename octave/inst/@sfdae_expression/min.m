% SPDX-License-Identifier: BSD-3-Clause
function [r, place] = min(a, b, dim)
% The smallest of two values, element by element, or of the rows or columns of an expression.
if nargout > 1
  unsupported('the position of the smallest element', 'use the value alone');
end
if nargin >= 2 && ~isempty(b)
  r = applied('min', a, b);
else
  if nargin < 3
    dim = [];
  end
  r = reduced('min', a, dim, 0);
end
end
