% SPDX-License-Identifier: BSD-3-Clause
function r = transpose(a)
% a.', the transposed expression.
a.id = a.id.';
r = a;
end
