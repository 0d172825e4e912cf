% SPDX-License-Identifier: BSD-3-Clause
function r = sumsq(a, varargin)
% Sum of squares of the rows or columns.
r = sum(a .* a, varargin{:});
end
