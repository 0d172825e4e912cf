% SPDX-License-Identifier: BSD-3-Clause
function r = horzcat(varargin)
% [a, b] of expressions and numbers.
for k = 1:numel(varargin)
  if isa(varargin{k}, 'sfdae_expression')
    r = varargin{k};     % reused: the constructor takes longer
    varargin{k} = r.id;
  else
    varargin{k} = sfdae_mex('nodes', operand(varargin{k}));
  end
end
r.id = horzcat(varargin{:});
r.is_condition = false;
end
