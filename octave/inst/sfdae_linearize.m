% SPDX-License-Identifier: BSD-3-Clause
function system = sfdae_linearize(problem, t, x, varargin)
% sfdae_linearize  Linearization at a point as a descriptor system E dx' = A dx + B du, y = C dx + D du.
%
%   system = sfdae_linearize(problem, t, x, options)
%
% problem: as for sfdae_solve; x: a consistent point, for example an equilibrium, [] for linear problems. E = F_x',
% A = -F_x, B = -F_u there. Options (see sfdae_options):
%
%   inputs          names of parameters (a text or cell array), or numbers of unknowns that are functions of time
%   input_columns   m x q matrix: inputs that are added to the right-hand side of E x' = A x + f
%   outputs         numbers of unknowns
%   output_rows     p x n matrix: further outputs y = output_rows * x
%   xdot            the derivative of x there; by default it is computed
%
% system has the fields E, A, B, C, D. sfdae_poles, sfdae_invariant_zeros, sfdae_transfer evaluate it, and
% sfdae_to_dss makes a system of the package control of it.
%
% Example:
%   F = @(t, x, xdot, p) [xdot(1) - x(2); xdot(2) + x(1) + 0.2 * x(2) - p.force];
%   options = sfdae_options('parameters', struct('force', 0), 'inputs', 'force', 'outputs', 1);
%   system = sfdae_linearize(F, 0, [0; 0], options);
%   sfdae_poles(system)     % -0.1 + 0.995i, -0.1 - 0.995i
%
% See also: sfdae_poles, sfdae_invariant_zeros, sfdae_transfer, sfdae_to_dss
if nargin < 2
  error('sfdae:illegal_argument', 'sfdae_linearize needs a problem and t');
end
if nargin < 3
  x = [];
end
options = given_options('sfdae_linearize', varargin);
need_time('sfdae_linearize', t);
[p, o, options, x] = prepared('sfdae_linearize', problem, x, options);
n = p.num_unknowns;
at = struct('t', t);
if isempty(x) && strncmp(p.form, 'linear', 6)
  x = zeros(n, 1);
  at.xdot = zeros(n, 1);
elseif isempty(x)
  error('sfdae:illegal_argument', 'sfdae_linearize: x is needed; only linear problems have the same matrices at any x');
end
at.x = x;
if isfield(options, 'xdot')
  at.xdot = options.xdot;
end
at = with_inputs(at, options, p);
if isfield(options, 'outputs')
  flags(options.outputs, n, 'the option outputs');
  at.output_unknowns = options.outputs;
end
if isfield(options, 'output_rows')
  if size(options.output_rows, 2) ~= n
    error('sfdae:illegal_argument', 'the option output_rows has %d columns; there are %d unknowns', ...
          size(options.output_rows, 2), n);
  end
  at.output_rows = options.output_rows;
end
found = sfdae_mex('linearize', p, o, at);
check_result(found, true);
system = struct('E', found.E, 'A', found.A, 'B', found.B, 'C', found.C, 'D', found.D);
end

function at = with_inputs(at, options, p)
if isfield(options, 'inputs') && iscell(options.inputs)
  at.input_parameters = options.inputs(:);
elseif isfield(options, 'inputs')
  flags(options.inputs, p.num_unknowns, 'the option inputs');
  at.input_unknowns = options.inputs;
end
if isfield(options, 'input_columns')
  if size(options.input_columns, 1) ~= p.num_equations
    error('sfdae:illegal_argument', 'the option input_columns has %d rows; there are %d equations', ...
          size(options.input_columns, 1), p.num_equations);
  end
  at.input_columns = options.input_columns;
end
end
