% SPDX-License-Identifier: BSD-3-Clause
function r = asin(a)
% Inverse sine, element by element.
r = applied('asin', a);
end
