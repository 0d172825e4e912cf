% SPDX-License-Identifier: BSD-3-Clause
function r = conj(a)
% Conjugate: the expression itself, element by element.
r = a;
end
