% SPDX-License-Identifier: BSD-3-Clause
function r = csc(a)
% Cosecant, element by element.
r = 1 ./ sin(a);
end
