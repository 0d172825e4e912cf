% SPDX-License-Identifier: BSD-3-Clause
function r = reshape(a, varargin)
% The elements in another shape.
a.id = reshape(a.id, varargin{:});
r = a;
end
