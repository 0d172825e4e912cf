% SPDX-License-Identifier: BSD-3-Clause
function test_events()
% A ball that falls from height 1: it is at the ground at sqrt(2 / 9.81), with the velocity -sqrt(2 * 9.81).
F = @(t, x, xdot) [xdot(1) - x(2); xdot(2) + 9.81];
options = sfdae_options('rtol', 1e-9, 'atol', 1e-9, 'events', @ground);
[T, X, TE, XE, IE] = sfdae_solve(F, [0 2], [1; 0], options);
assert(TE, sqrt(2 / 9.81), 1e-8);
assert(XE, [0, -sqrt(2 * 9.81)], 1e-7);
assert(IE, 1);
assert(T(end), TE);
assert(X(end, :), XE);

% Given output times: the last output is the event.
[T, X] = sfdae_solve(F, 0:0.1:2, [1; 0], options);
assert(T, [(0:0.1:0.4).'; TE], 1e-12);
assert(X(end, 1), 0, 1e-12);

% Bounces with restitution 0.8; the third ends the run, as `isterminal` says.
bounces = sfdae_options(options, 'events', @(t, x, xdot) deal(x(1), 3, -1), ...
                        'event_action', @(t, x, xdot, which) [0; -0.8 * x(2)]);
sol = sfdae_solve(F, [0 10], [1; 0], bounces);
first = sqrt(2 / 9.81);
assert(sol.xe, first * [1, 1 + 1.6, 1 + 1.6 + 1.28], 1e-6);
assert(sol.ie, [1 1 1]);
assert(sol.rising, [-1 -1 -1]);
assert(sol.status_name, 'SFDAE_EVENT');
assert(~isempty(strfind(sol.message, 'an event ended the integration')));

% Several events, directions, and no terminal one.
oscillator = @(t, x, xdot) [xdot(1) - x(2); xdot(2) + x(1)];
several = sfdae_options('rtol', 1e-9, 'atol', 1e-9, 'events', @(t, x, xdot) deal([x(1); x(2)], [0; 0], [1; 0]));
sol = sfdae_solve(oscillator, [0 7], [1; 0], several);
assert(sol.xe(sol.ie == 1), 1.5 * pi, 1e-7);
assert(sol.xe(sol.ie == 2), [pi, 2 * pi], 1e-7);
assert(sol.status, 0);

% Conditions of recorded equations are located without events; breakpoints end steps.
switched = @(t, x, xdot) xdot - ifelse(t > 0.5, 2, 0);
sol = sfdae_solve(switched, [0 1], 0);
assert(sol.y(end), 1, 1e-6);
assert(numel(sol.switches), 1);
assert(sol.switches(1).t, 0.5, 1e-9);
[~, X] = sfdae_solve(@(t, x, xdot) xdot - step_input(t), [0 1], 0, ...
                     sfdae_options('record', false, 'breakpoints', 0.25));
assert(X(end), 0.75, 1e-6);

% The monitor stops a run.
state = warning('off', 'all');
sol = sfdae_solve(oscillator, [0 100], [1; 0], sfdae_options('monitor', @(t, x, h, order, steps) t > 3));
warning(state);
assert(sol.status_name, 'SFDAE_STOPPED');
assert(sol.x(end) > 3 && sol.x(end) < 10);
end

function [value, isterminal, direction] = ground(t, x, xdot)
value = x(1);
isterminal = 1;
direction = -1;
end

function u = step_input(t)
u = double(t > 0.25);
end
