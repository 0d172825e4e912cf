% SPDX-License-Identifier: BSD-3-Clause
function r = applied(operation, varargin)
% The expression that an operation of sfdae_mex makes of expressions and numbers, element by element.
for k = 1:numel(varargin)
  if isa(varargin{k}, 'sfdae_expression')
    r = varargin{k};     % reused: the constructor takes longer
    varargin{k} = r.id;
  else
    varargin{k} = operand(varargin{k});
  end
end
r.id = sfdae_mex(operation, varargin{:});
r.is_condition = false;
end
