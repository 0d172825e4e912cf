% SPDX-License-Identifier: BSD-3-Clause
function r = iscomplex(a)
% False: expressions are real.
r = false;
end
