% SPDX-License-Identifier: BSD-3-Clause
function r = uplus(a)
% +a: the expression itself.
r = a;
end
