% SPDX-License-Identifier: BSD-3-Clause
function r = cat(dim, varargin)
% Concatenation along a dimension, 1 or 2.
if isequal(dim, 1)
  r = vertcat(varargin{:});
elseif isequal(dim, 2)
  r = horzcat(varargin{:});
else
  error('sfdae:illegal_argument', 'expressions are concatenated along the dimensions 1 and 2 only');
end
end
