% SPDX-License-Identifier: BSD-3-Clause
function r = acos(a)
% Inverse cosine, element by element.
r = applied('acos', a);
end
