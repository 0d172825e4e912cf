% SPDX-License-Identifier: BSD-3-Clause
function r = exp(a)
% Exponential function, element by element.
r = applied('exp', a);
end
