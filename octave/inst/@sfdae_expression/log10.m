% SPDX-License-Identifier: BSD-3-Clause
function r = log10(a)
% Decimal logarithm, element by element.
r = applied('log10', a);
end
