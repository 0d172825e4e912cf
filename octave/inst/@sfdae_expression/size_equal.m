% SPDX-License-Identifier: BSD-3-Clause
function r = size_equal(varargin)
% True if all arguments have the same size.
r = true;
for k = 2:numel(varargin)
  r = r && isequal(size(varargin{1}), size(varargin{k}));
end
end
