% SPDX-License-Identifier: BSD-3-Clause
function r = colon(varargin)
% a:b needs numbers.
unsupported('a range a:b of expressions', 'use ranges of numbers');
r = [];
end
