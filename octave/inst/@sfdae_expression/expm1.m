% SPDX-License-Identifier: BSD-3-Clause
function r = expm1(a)
% exp(a) - 1 without cancellation, element by element.
r = 2 * exp(a / 2) .* sinh(a / 2);
end
