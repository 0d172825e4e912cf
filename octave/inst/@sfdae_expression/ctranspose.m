% SPDX-License-Identifier: BSD-3-Clause
function r = ctranspose(a)
% a', the transposed expression: expressions are real.
a.id = a.id.';
r = a;
end
