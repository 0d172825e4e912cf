% SPDX-License-Identifier: BSD-3-Clause
function problem = sfdae_nonlinear(F, varargin)
% sfdae_nonlinear  Problem F(t, x, x') = 0 with properties of its own.
%
%   problem = sfdae_nonlinear(F, 'name', value, ...)
%   problem = sfdae_nonlinear([], 'total_derivative', fn, 'num_equations', m, ...)
%
% sfdae_solve accepts the function F itself, and these properties as options. This function collects them:
%
%   parameters, record, jacobian, pattern_x, pattern_xdot, equation_names, prescribed, prescribed_values,
%   differentiations    see help sfdae_options
%   num_unknowns        n; default: as many as start values
%   num_equations       m, for record = false; default: n
%   total_derivative    [F, F_x, F_xdot] = fn(t, order, derivatives), in place of F: total derivatives of that order
%                       along the jet with the columns x, x', ..., x^(order+1); [] if an order is not available
%
% Example:
%   problem = sfdae_nonlinear(@(t, x, xdot, p) xdot + p.k * x, 'parameters', struct('k', 2));
%   [T, X] = sfdae_solve(problem, [0 1], 1);
%
% See also: sfdae_solve, sfdae_linear, sfdae_multibody
if nargin < 1 || ~(is_function_handle(F) || isempty(F))
  error('sfdae:illegal_argument', 'sfdae_nonlinear needs a function handle F(t, x, xdot), or [] and total_derivative');
end
names = {'parameters', 'record', 'jacobian', 'pattern_x', 'pattern_xdot', 'equation_names', 'prescribed', ...
         'prescribed_values', 'differentiations', 'num_unknowns', 'num_equations', 'total_derivative'};
problem = properties_of('sfdae_nonlinear', names, varargin);
problem.kind = 'nonlinear';
problem.F = F;
if isempty(F) && ~isfield(problem, 'total_derivative')
  error('sfdae:illegal_argument', 'sfdae_nonlinear: F is [], so total_derivative is needed');
end
end
