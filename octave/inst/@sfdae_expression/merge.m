% SPDX-License-Identifier: BSD-3-Clause
function r = merge(condition, a, b)
% The same as ifelse.
r = ifelse(condition, a, b);
end
