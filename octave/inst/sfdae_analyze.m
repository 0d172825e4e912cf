% SPDX-License-Identifier: BSD-3-Clause
function result = sfdae_analyze(problem, t, x, varargin)
% sfdae_analyze  Index and characteristic values of a differential-algebraic equation.
%
%   result = sfdae_analyze(problem, t, x)
%   result = sfdae_analyze(problem, t, x, options)
%
% problem: as for sfdae_solve. x: values near the solution, which need not be consistent; [] for linear problems. The
% index is determined at t and at a nearby point in the direction of the option toward, by default t + 1. Fields:
%
%   strangeness_index       mu; the differentiation index is mu + 1, or 0 if a = 0
%   differentiation_index
%   d, a, u, v              differential and algebraic equations, free unknowns, redundant equations
%   smallest_gap            of all rank decisions; 1000 and above is clear
%   decisions               struct array of all rank decisions
%   structure               structural analysis: differentiations, orders, verdict, ...
%   report                  all of it as text
%
% Example:
%   F = @(t, x, xdot) [xdot(1) - x(2); x(1) - sin(t)];
%   result = sfdae_analyze(F, 0, [0; 0]);
%   result.strangeness_index     % 1
%
% See also: sfdae_solve, sfdae_decic
if nargin < 1
  error('sfdae:illegal_argument', 'sfdae_analyze needs a problem');
end
if nargin < 2
  t = 0;
end
if nargin < 3
  x = [];
end
options = given_options('sfdae_analyze', varargin);
need_time('sfdae_analyze', t);
is_linear = isstruct(problem) && isfield(problem, 'kind') && strcmp(problem.kind, 'linear');
if isempty(x) && ~is_linear
  error('sfdae:illegal_argument', ...
        'sfdae_analyze: x is needed; the index of a nonlinear problem depends on the solution');
end
[p, o, options, x] = prepared('sfdae_analyze', problem, x, options);
at = struct('t', t, 'toward', t + 1);
if ~isempty(x) && ~strcmp(p.form, 'linear')
  at.x = x;
elseif strcmp(p.form, 'linear_equations')
  at.x = zeros(p.num_unknowns, 1);
end
if isfield(options, 'toward')
  at.toward = options.toward;
end
found = sfdae_mex('analyze', p, o, at);
check_result(found, true);
c = found.characteristics;
result = struct('strangeness_index', c.strangeness_index, 'differentiation_index', ...
                (c.strangeness_index + 1) * (c.a > 0), 'd', c.d, 'a', c.a, 'u', c.u, 'v', c.v, 't', c.t, 'rank_E', ...
                c.rank_E, 'smallest_gap', c.smallest_gap, 'message', found.message, 'report', found.report);
result.decisions = found.decisions;
result.structure = found.structure;
end
