% SPDX-License-Identifier: BSD-3-Clause
function r = vertcat(varargin)
% [a; b] of expressions and numbers.
parts = cell(size(varargin));
for k = 1:numel(varargin)
  parts{k} = sfdae_mex('nodes', operand(varargin{k}));
end
r = sfdae_expression(vertcat(parts{:}));
end
