% SPDX-License-Identifier: BSD-3-Clause
function options = sfdae_options(varargin)
% sfdae_options  Options of sfdae_solve, sfdae_analyze, sfdae_decic and sfdae_linearize.
%
%   options = sfdae_options('name', value, ...)
%   options = sfdae_options(old, 'name', value, ...)     changes options; [] removes one
%   sfdae_options()                                      without an output: shows all names
%
% A struct of odeset is accepted in place of `old`, and its names in place of those here.
%
% Accuracy
%   rtol, atol         the error of x(i) is kept near rtol |x(i)| + atol: numbers, or vectors; 1e-6
% Integration
%   method             'bdf' (default), 'radau' (smooth problems, tight tolerances) or 'automatic'
%   max_order          of BDF, 1 to 5
%   min_stages, max_stages   of Radau: 1, 3, 5 or 7
%   initial_step, max_step   step sizes
%   max_steps          attempted steps in the whole run; 100000
%   output             'consistent' (default) or 'interpolated': constraints at outputs within steps
%   breakpoints        times of kinks in the data, at which steps end
%   breakpoint_kinds   0 (kink) or 1 (x may jump) for each of them
%   dense              false: no data for sfdae_deval
%   monitor            @(t, x, step, order, steps), called after every step; true stops the run
% Start
%   fixed              unknowns whose start values must not change: numbers i, or true and false for each
%   initial_values     'nearest' (default), 'fixed' or 'accept'
%   initial_weights    start values change as little as possible in these units
%   xdot0              an initial guess of xdot, for problems that allow several
% Equations
%   parameters         struct of values: the function gets them as one more argument, p
%   record             false: F is called with numbers, for code that cannot be recorded
%   jacobian           for record = false: [F_x, F_xdot] = jacobian(t, x, xdot)
%   pattern_x, pattern_xdot   for record = false: sparse matrices that are not 0 where F_x, F_xdot may be
%   equation_names     cell array of texts, for messages
%   prescribed, prescribed_values   if the solution is not unique: unknowns given as functions, @(t)
%   differentiations   how often each equation is differentiated at most
%   structure          'automatic' (default), 'required' (sparse matrices) or 'off'
%   conditions         'events' (default) or 'smooth'
% Events
%   events             [value, isterminal, direction] = events(t, x, xdot), as for ode15i; isterminal = k
%                      ends the run at the k-th event
%   event_action       @(t, x, xdot, ie): x with which the run continues, or []
% Sensitivities
%   sensitivities      names of parameters, or numbers of unknowns (start values): sol.S
% Index analysis
%   max_index, reduction, rank_tol, time_scale, leading_term, ignore_inconsistency, consistency_tol,
%   difference_derivatives, difference_step, check_derivatives: see the header sfdae.h
%
% Example:
%   options = sfdae_options('rtol', 1e-8, 'atol', [1e-8; 1e-14; 1e-8], 'method', 'radau');
%   options = sfdae_options(options, 'max_step', 0.1);
%
% See also: sfdae_solve
if nargin == 0 && nargout == 0
  fprintf('%s\n', strjoin(option_names(), ', '));
  return
end
options = struct();
first = 1;
if nargin > 0 && isstruct(varargin{1})
  options = checked_options(varargin{1});
  first = 2;
end
if mod(nargin - first + 1, 2) ~= 0
  error('sfdae:illegal_argument', 'sfdae_options: names and values have to come in pairs');
end
for k = first:2:nargin
  if ~ischar(varargin{k})
    error('sfdae:illegal_argument', 'sfdae_options: argument %d has to be the name of an option', k);
  end
  options.(option_name(varargin{k})) = varargin{k + 1};
end
options = checked_options(options);
end
