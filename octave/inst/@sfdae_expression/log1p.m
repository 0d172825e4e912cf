% SPDX-License-Identifier: BSD-3-Clause
function r = log1p(a)
% log(1 + a), element by element.
r = log(1 + a);
end
