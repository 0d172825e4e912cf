% SPDX-License-Identifier: BSD-3-Clause
function varargout = size(a, varargin)
% Size of the array of expressions.
if nargout > 1
  varargout = cell(1, nargout);
  [varargout{:}] = size(a.id, varargin{:});
else
  varargout = {size(a.id, varargin{:})};
end
end
