% SPDX-License-Identifier: BSD-3-Clause
function r = repmat(a, varargin)
% Copies of the expression, side by side.
a.id = repmat(a.id, varargin{:});
r = a;
end
