% SPDX-License-Identifier: BSD-3-Clause
function r = cot(a)
% Cotangent, element by element.
r = 1 ./ tan(a);
end
