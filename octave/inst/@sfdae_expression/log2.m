% SPDX-License-Identifier: BSD-3-Clause
function r = log2(a)
% Logarithm of base 2, element by element.
r = log(a) / log(2);
end
