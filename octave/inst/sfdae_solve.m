% SPDX-License-Identifier: BSD-3-Clause
function varargout = sfdae_solve(problem, tspan, x0, varargin)
% sfdae_solve  Solves a differential-algebraic equation of any index.
%
%   sol = sfdae_solve(F, tspan, x0)
%   sol = sfdae_solve(F, tspan, x0, options)
%   [T, X] = sfdae_solve(...)
%   [T, X, TE, XE, IE] = sfdae_solve(...)
%
% F is a function F(t, x, xdot) that returns the vector of equations F(t, x, x') = 0, or F(t, x, xdot, p) with
% parameters p. It is called once, with expressions (help sfdae_expression), recorded, and differentiated exactly. For
% code that cannot be recorded, sfdae_options('record', false) calls F with numbers at every point; the differentiation
% index must then be 0 or 1. In place of F: a problem of sfdae_linear, sfdae_multibody or sfdae_nonlinear.
%
% tspan is [t0 t1], and outputs are the ends of all steps; or it has more times, at which the outputs are. t1 may come
% before t0. x0 has n start values: use 0 as the initial guess of anything unknown (forces, currents). The library finds
% consistent values, and keeps the differential variables if possible.
%
% T is a column of times; rows of X are values at these times. TE, XE, IE: times, values and numbers of events. sol has
% the fields
%
%   x, y, xdot         times (a row), values (n x number of times), their derivatives
%   xe, ye, ie         times, values (n x number of events) and numbers of events; rising: 1 or -1
%   status, message    0 and text; names of statuses are in status_name
%   strangeness_index, d, a, u, v   characteristic values
%   stats              numbers of steps, factorizations, ...
%   switches           times and texts of conditions that switched
%   initial, report    changes of start values; the diagnostics report as text
%   S                  sensitivities, n x (number of parameters) x (number of times)
%   dense              for sfdae_deval
%
% If the integration fails or is stopped (Ctrl-C), the part reached is returned, with a warning. An error of F is raised
% as it is. F asks for a smaller step by error('sfdae:retry', ...).
%
% Example (a pendulum in Cartesian coordinates with unknown rod force, differentiation index 3):
%   F = @(t, x, xdot) [xdot(1) - x(3); xdot(2) - x(4); ...
%                      xdot(3) + 2 * x(1) * x(5); xdot(4) + 2 * x(2) * x(5) + 9.81; ...
%                      x(1)^2 + x(2)^2 - 1];
%   sol = sfdae_solve(F, [0 10], [0.6; -0.8; 0; 0; 0], sfdae_options('rtol', 1e-8));
%   [T, X] = sfdae_solve(F, 0:0.1:10, [0.6; -0.8; 0; 0; 0]);
%   plot(T, X(:, 1:2))
%
% See also: sfdae_options, sfdae_deval, sfdae_decic, sfdae_analyze, sfdae_linear, sfdae_multibody, sfdae_linearize
if nargin < 3
  error('sfdae:illegal_argument', 'sfdae_solve needs a problem, tspan and x0');
end
options = given_options('sfdae_solve', varargin);
if isempty(x0)
  error('sfdae:illegal_argument', 'sfdae_solve: x0 is empty; it has to have a value for each unknown');
end
times = checked_times(tspan);
[p, o, options, x0] = prepared('sfdae_solve', problem, x0, options);
run = with_events(new_run(times, x0, options, nargout), options, p, times(1), x0);
if ~isfield(options, 'max_steps') && numel(times) > 2
  run.limit_is_default = 1;
end
o.use_stop_time = 1;
o.stop_time = times(end);
o.xdot_is_guess = double(isfield(options, 'xdot0'));
result = sfdae_mex('solve', p, o, run);
check_result(result, ~result.has_started);
warn(result);
if nargout <= 1
  varargout = {solution_of(result, p, options)};
else
  varargout = {result.t.', result.x.', result.te.', result.xe.', result.ie.'};
  varargout = varargout(1:min(nargout, 5));
end
end

function times = checked_times(tspan)
if ~(isnumeric(tspan) && isreal(tspan) && isvector(tspan) && numel(tspan) >= 2)
  error('sfdae:illegal_argument', 'sfdae_solve: tspan has to be [t0 t1] or a vector of times');
end
times = full(double(tspan(:)));
if any(~isfinite(times))
  error('sfdae:illegal_argument', 'sfdae_solve: tspan has to be finite; tspan(%d) is %g', ...
        find(~isfinite(times), 1), times(find(~isfinite(times), 1)));
end
steps = diff(times);
bad = find(steps * sign(times(end) - times(1)) <= 0, 1);
if ~isempty(bad)
  error('sfdae:illegal_argument', ['sfdae_solve: the times of tspan have to increase or decrease; tspan(%d) = %g ' ...
        'is followed by %g'], bad, times(bad), times(bad + 1));
end
end

function run = new_run(times, x0, options, count)
n = numel(x0);
run = struct('t0', times(1), 't1', times(end), 'x0', x0, 'wants_xdot', double(count <= 1), 'dense', double(count <= 1));
if numel(times) > 2
  run.tout = times;
end
if isfield(options, 'dense')
  run.dense = double(options.dense);
end
for name = {'breakpoints', 'breakpoint_kinds', 'xdot0'}
  if isfield(options, name{1})
    run.(name{1}) = options.(name{1})(:);
  end
end
if isfield(run, 'xdot0') && numel(run.xdot0) ~= n
  error('sfdae:illegal_argument', 'the option xdot0 has %d elements; there are %d unknowns', numel(run.xdot0), n);
end
if isfield(run, 'breakpoint_kinds') && (~isfield(run, 'breakpoints') || ...
                                        numel(run.breakpoint_kinds) ~= numel(run.breakpoints))
  error('sfdae:illegal_argument', 'the option breakpoint_kinds needs one number for each of the breakpoints');
end
if isfield(options, 'monitor')
  run.monitor = options.monitor;
end
if isfield(options, 'sensitivities')
  [run.sensitivities, run.sensitivity_directions] = sensitivities_of(options.sensitivities, n);
end
end

function [names, directions] = sensitivities_of(given, n)
% Names of parameters, '' for start values; and the derivatives of the start values, one column for each.
if iscell(given)
  names = given(:).';
  directions = zeros(n, numel(names));
else
  flags(given, n, 'the option sensitivities');
  names = repmat({''}, 1, numel(given));
  directions = eye(n);
  directions = directions(:, given);
end
end

function run = with_events(run, options, p, t0, x0)
if ~isfield(options, 'events')
  if isfield(options, 'event_action')
    error('sfdae:illegal_argument', 'the option event_action needs the option events');
  end
  return
end
events = with_parameters(options.events, 3, options.parameters);
[run.num_events, run.event_limits, run.event_directions, run.event_outputs] = ...
  checked_events(events, t0, x0, p.num_unknowns);
run.events = events;
if isfield(options, 'event_action')
  run.event_action = with_parameters(options.event_action, 4, options.parameters);
end
end

function [count, limits, directions, outputs] = checked_events(events, t0, x0, n)
% Number, limits and directions of events, and outputs of their function, from a call at the start.
outputs = 3;
try
  [value, limits, directions] = events(t0, x0, zeros(n, 1));
catch
  outputs = 1;
  value = events(t0, x0, zeros(n, 1));
  limits = [];
  directions = [];
end
count = numel(value);
if count == 0 || ~(isnumeric(value) || islogical(value)) || ~isreal(value)
  error('sfdae:illegal_argument', 'the event function returned no vector of real numbers at the start');
end
limits = one_each('isterminal', limits, count);
directions = sign(one_each('direction', directions, count));
if any(limits < 0)
  error('sfdae:illegal_argument', ...
        'isterminal of events has to be false, true, or the number of the event that ends the run');
end
end

function value = one_each(name, value, count)
value = double(value(:));
if isempty(value)
  value = zeros(count, 1);
elseif isscalar(value)
  value = value * ones(count, 1);
elseif numel(value) ~= count
  error('sfdae:illegal_argument', '%s of events has %d elements; there are %d events', name, numel(value), count);
end
end

function warn(result)
if ~isempty(result.notes)
  warning('sfdae:note', '%s', result.notes);
end
if result.status < 0
  warning(identifier_of(result.status_name), 'the integration ended at t = %.9g: %s', result.last_t, result.message);
elseif result.was_interrupted
  warning('sfdae:stopped', 'interrupted by the user at t = %.9g', result.last_t);
end
end

function sol = solution_of(result, p, options)
n = p.num_unknowns;
sol = struct('solver', 'sfdae', 'x', result.t, 'y', result.x, 'xdot', result.xdot, 'xe', result.te, 'ye', result.xe, ...
             'ie', result.ie, 'rising', result.rising, 'status', result.status, 'status_name', result.status_name, ...
             'message', end_message(result));
c = result.characteristics;
for name = {'strangeness_index', 'd', 'a', 'u', 'v'}
  sol.(name{1}) = c.(name{1});
end
sol.stats = result.statistics;
sol.switches = result.switches;
sol.initial = result.initial;
sol.report = result.report;
if isfield(options, 'sensitivities')
  sol.S = reshape(result.S, n, [], numel(result.t));
end
if isfield(result, 'dense')
  sol.dense = result.dense;
end
end

function text = end_message(result)
if result.status == 0
  text = 'the end of the interval was reached';
elseif strcmp(result.status_name, 'SFDAE_STOPPED')
  text = sprintf('stopped at t = %.9g', result.last_t);
elseif result.status < 0
  text = sprintf('the integration ended at t = %.9g: %s', result.last_t, result.message);
else
  text = result.message;
end
if ~isempty(result.notes)
  text = sprintf('%s; %s', text, result.notes);
end
end
