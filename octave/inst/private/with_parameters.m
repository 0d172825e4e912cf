% SPDX-License-Identifier: BSD-3-Clause
function fn = with_parameters(fn, count, parameters)
% A function of `count` arguments, if it has one more: the parameters.
if takes_parameters(fn, count, parameters)
  fn = @(varargin) fn(varargin{1:count}, parameters);
end
end
