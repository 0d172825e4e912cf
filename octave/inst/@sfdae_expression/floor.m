% SPDX-License-Identifier: BSD-3-Clause
function r = floor(a)
% Largest integer up to a, element by element.
r = applied('floor', a);
end
