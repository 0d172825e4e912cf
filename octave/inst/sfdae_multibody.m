% SPDX-License-Identifier: BSD-3-Clause
function problem = sfdae_multibody(M, f, g, varargin)
% sfdae_multibody  Mechanical system with constraints.
%
%   problem = sfdae_multibody(M, f, g, 'name', value, ...)
%
%   q' = S v,   M v' = f - G' lambda - H' kappa,   0 = g,   0 = H v + h,   G = g_q S
%
% The unknowns are x = (q, v, lambda, kappa); start values of q and v suffice. M(t, q) is the mass matrix, f(t, q, v)
% the forces and g(t, q) the holonomic constraints; [] for M is the identity, for f zero, for g none. Functions are
% recorded, constant ones may be matrices. Properties:
%
%   num_positions, num_velocities   nq and nv; needed unless M is a matrix; default nv = nq
%   kinematics                      S(t, q), nq x nv; default: the identity
%   nonholonomic_matrix, nonholonomic_offset   H(t, q) and h(t, q)
%   parameters                      struct of values: functions get them as one more argument
%   coordinates                     'orthogonal' (default) or 'permutation'
%   constraint_names                cell array of texts, for messages
%   record = false                  functions of numbers, with constraint_jacobian(t, q) = g_q; also
%                                   constraint_rate(t, q) = g_t, constraint_curvature(t, q, v),
%                                   nonholonomic_curvature(t, q, v), num_constraints, num_nonholonomic
%
% Example:
%   M = eye(2);
%   f = @(t, q, v) [0; -9.81];
%   g = @(t, q) q(1)^2 + q(2)^2 - 1;
%   sol = sfdae_solve(sfdae_multibody(M, f, g), [0 1], [0.6; -0.8; 0; 0]);
%   sol.strangeness_index     % 2
%
% See also: sfdae_solve
if nargin < 2
  error('sfdae:illegal_argument', 'sfdae_multibody needs M and f');
end
if nargin < 3
  g = [];
end
functions = {'kinematics', 'nonholonomic_matrix', 'nonholonomic_offset', 'constraint_jacobian', 'constraint_rate', ...
             'constraint_curvature', 'nonholonomic_curvature'};
others = {'num_positions', 'num_velocities', 'num_constraints', 'num_nonholonomic', 'parameters', 'coordinates', ...
          'constraint_names', 'record'};
problem = properties_of('sfdae_multibody', [functions, others], varargin);
problem.kind = 'multibody';
problem.mass = M;
problem.forces = f;
problem.constraints = g;
for name = [{'mass', 'forces', 'constraints'}, functions]
  if isfield(problem, name{1})
    check_part(name{1}, problem.(name{1}));
  end
end
if ~isfield(problem, 'num_positions')
  if is_function_handle(M) || isempty(M)
    error('sfdae:illegal_argument', 'sfdae_multibody: num_positions is needed if M is not a matrix');
  end
  problem.num_positions = size(M, 1);
end
if ~isfield(problem, 'num_velocities')
  problem.num_velocities = problem.num_positions;
end
end

function check_part(name, value)
if ~is_function_handle(value) && ~(isnumeric(value) && isreal(value))
  error('sfdae:illegal_argument', ...
        'sfdae_multibody: %s has to be a function handle or a real matrix, not of class %s', name, class(value));
end
end
