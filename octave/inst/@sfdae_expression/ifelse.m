% SPDX-License-Identifier: BSD-3-Clause
function r = ifelse(condition, a, b)
% a where the condition holds (is not 0), else b; the one not chosen need not be defined.
r = applied('choose', truth(condition), a, b);
end
