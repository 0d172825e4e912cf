% SPDX-License-Identifier: BSD-3-Clause
function r = ismatrix(a)
% True: expressions are matrices.
r = true;
end
