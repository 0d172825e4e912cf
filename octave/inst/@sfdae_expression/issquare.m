% SPDX-License-Identifier: BSD-3-Clause
function r = issquare(a)
% True for a square matrix.
r = size(a.id, 1) == size(a.id, 2);
end
