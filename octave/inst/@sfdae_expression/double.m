% SPDX-License-Identifier: BSD-3-Clause
function r = double(a)
% An expression has no value while equations are recorded.
unsupported('the conversion of an expression to a number', 'an expression has no value while equations are written');
r = [];
end
