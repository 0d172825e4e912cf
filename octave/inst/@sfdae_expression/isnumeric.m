% SPDX-License-Identifier: BSD-3-Clause
function r = isnumeric(a)
% True: expressions stand for numbers.
r = true;
end
