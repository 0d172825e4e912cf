% SPDX-License-Identifier: BSD-3-Clause
function r = isfloat(a)
% True: expressions stand for numbers of class double.
r = true;
end
