% SPDX-License-Identifier: BSD-3-Clause
function r = length(a)
% Size of the longest dimension.
r = length(a.id);
end
