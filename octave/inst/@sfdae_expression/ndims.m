% SPDX-License-Identifier: BSD-3-Clause
function r = ndims(a)
% Number of dimensions: 2.
r = 2;
end
