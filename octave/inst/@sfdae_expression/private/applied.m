% SPDX-License-Identifier: BSD-3-Clause
function r = applied(operation, varargin)
% The expression that an operation of sfdae_mex makes of expressions and numbers, element by element.
for k = 1:numel(varargin)
  varargin{k} = operand(varargin{k});
end
r = sfdae_expression(sfdae_mex(operation, varargin{:}));
end
