% SPDX-License-Identifier: BSD-3-Clause
function r = log(a)
% Natural logarithm, element by element.
r = applied('log', a);
end
