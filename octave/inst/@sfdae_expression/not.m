% SPDX-License-Identifier: BSD-3-Clause
function r = not(a)
% ~a, element by element; true means not 0.
r = applied('not', truth(a));
r.is_condition = true;
end
