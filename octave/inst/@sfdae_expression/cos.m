% SPDX-License-Identifier: BSD-3-Clause
function r = cos(a)
% Cosine, element by element.
r = applied('cos', a);
end
