% SPDX-License-Identifier: BSD-3-Clause
function r = or(a, b)
% a | b, element by element; true means not 0.
r = applied('or', truth(a), truth(b));
r.is_condition = true;
end
