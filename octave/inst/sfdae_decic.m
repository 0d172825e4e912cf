% SPDX-License-Identifier: BSD-3-Clause
function [x, xdot, result] = sfdae_decic(problem, t0, x0, fixed, varargin)
% sfdae_decic  Consistent start values of a differential-algebraic equation of any index.
%
%   [x, xdot] = sfdae_decic(problem, t0, x0)
%   [x, xdot] = sfdae_decic(problem, t0, x0, fixed)
%   [x, xdot, result] = sfdae_decic(problem, t0, x0, fixed, options)
%
% problem: as for sfdae_solve. x is the consistent point near x0, hidden constraints included, and xdot the derivative
% of the solution through it. Components in `fixed` (numbers of unknowns, or true and false for each; [] for none) do
% not change; the others of the differential variables are kept if possible. sfdae_solve does all this itself. The
% option xdot0 is an initial guess of xdot, for problems that allow several. result: status, message, report and
% `initial`, the residual before and after and the largest change.
%
% Example:
%   F = @(t, x, xdot) [xdot(1) - x(2); x(1)^2 + x(2)^2 - 1];
%   [x, xdot] = sfdae_decic(F, 0, [0.6; 0.7], 1);     % x = [0.6; 0.8]
%
% See also: sfdae_solve, sfdae_analyze
if nargin < 3
  error('sfdae:illegal_argument', 'sfdae_decic needs a problem, t0 and x0');
end
options = given_options('sfdae_decic', varargin);
need_time('sfdae_decic', t0);
if nargin > 3 && ~isempty(fixed)
  options.fixed = fixed;
end
if isempty(x0)
  error('sfdae:illegal_argument', 'sfdae_decic: x0 is empty; it has to have a value for each unknown');
end
[p, o, options, x0] = prepared('sfdae_decic', problem, x0, options);
at = struct('t', t0, 'x', x0);
if isfield(options, 'xdot0')
  if numel(options.xdot0) ~= numel(x0)
    error('sfdae:illegal_argument', 'the option xdot0 has %d elements; there are %d unknowns', numel(options.xdot0), ...
          numel(x0));
  end
  at.xdot = options.xdot0(:);
  o.xdot_is_guess = 1;
end
found = sfdae_mex('consistent', p, o, at);
check_result(found, true);
x = found.x;
xdot = found.xdot;
if nargout < 3 && found.status > 0
  warning('sfdae:note', '%s', found.message);
end
result = struct('status', found.status, 'status_name', found.status_name, 'message', found.message, 'initial', ...
                found.initial, 'report', found.report);
end
