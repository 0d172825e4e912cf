% SPDX-License-Identifier: BSD-3-Clause
function r = trace(a)
% Sum of the diagonal.
r = sum(diag(a));
end
