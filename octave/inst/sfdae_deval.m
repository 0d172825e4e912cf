% SPDX-License-Identifier: BSD-3-Clause
function [x, xdot] = sfdae_deval(sol, t, which)
% sfdae_deval  Values of a solution at any times (dense output).
%
%   x = sfdae_deval(sol, t)             n x numel(t), as deval of MATLAB
%   x = sfdae_deval(sol, t, which)      only the unknowns with these numbers
%   [x, xdot] = sfdae_deval(...)        the derivatives as well
%
% sol is what sfdae_solve returns as one output, unless its option dense was false. t may lie anywhere between the start
% and the end of the integration. Constraints hold within the tolerances.
%
% Example:
%   sol = sfdae_solve(@(t, x, xdot) xdot + x, [0 2], 1);
%   sfdae_deval(sol, 1)     % exp(-1), to six digits
%
% See also: sfdae_solve
if nargin < 2
  error('sfdae:illegal_argument', 'sfdae_deval needs a solution and times');
end
if ~isstruct(sol) && isstruct(t)
  [sol, t] = deal(t, sol);     % deval accepts both orders
end
if ~isstruct(sol) || ~isfield(sol, 'dense')
  error('sfdae:illegal_argument', ['sfdae_deval: the first argument has no dense output; it has to be the single ' ...
        'output of sfdae_solve, without the option dense = false']);
end
if ~isnumeric(t) || ~isreal(t)
  error('sfdae:illegal_argument', 'sfdae_deval: times have to be real numbers, not of class %s', class(t));
end
result = sfdae_mex('evaluate', sol.dense, full(double(t(:))));
if result.status < 0
  error('sfdae:illegal_argument', 'sfdae_deval: %s', result.message);
end
x = result.x;
xdot = result.xdot;
if nargin > 2
  flags(which, size(x, 1), 'sfdae_deval: the third argument');
  x = x(which, :);
  xdot = xdot(which, :);
end
end
