% SPDX-License-Identifier: BSD-3-Clause
function r = horzcat(varargin)
% horzcat  Rows of numbers (class single) within a matrix that contains expressions.
%
% Octave looks for this function when it makes a row without expressions of a matrix such as [0 0; 1 x(1)], and fails
% without it. It calls the function of Octave; MATLAB does not need it.
r = builtin('horzcat', varargin{:});
end
