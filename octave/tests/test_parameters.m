% SPDX-License-Identifier: BSD-3-Clause
function test_parameters()
% Parameters, sensitivities, and functions with one more argument.
F = @(t, x, xdot, p) xdot + p.k * x;
options = sfdae_options('parameters', struct('k', 2), 'rtol', 1e-9, 'atol', 1e-11);
[~, X] = sfdae_solve(F, [0 1], 1, options);
assert(X(end), exp(-2), 1e-8);
[~, X] = sfdae_solve(F, [0 1], 1, sfdae_options(options, 'parameters', struct('k', 3)));
assert(X(end), exp(-3), 1e-8);
[~, X] = sfdae_solve(F, [0 1], 1, sfdae_options(options, 'record', false));
assert(X(end), exp(-2), 1e-7);

% dx/dk = -t exp(-k t), dx/dx0 = exp(-k t).
sol = sfdae_solve(F, [0 0.5 1], 1, sfdae_options(options, 'sensitivities', 'k'));
assert(squeeze(sol.S), -sol.x(:) .* exp(-2 * sol.x(:)), 1e-6);
sol = sfdae_solve(F, [0 0.5 1], 1, sfdae_options(options, 'sensitivities', 1));
assert(squeeze(sol.S), exp(-2 * sol.x(:)), 1e-6);

% Vectors of parameters; a problem has its own, and options replace them.
G = @(t, x, xdot, p) xdot + p.k(1) * x - p.k(2);
problem = sfdae_nonlinear(G, 'parameters', struct('k', [1 2]));
[~, X] = sfdae_solve(problem, [0 1], 0, sfdae_options('rtol', 1e-9));
assert(X(end), 2 * (1 - exp(-1)), 1e-6);
[~, X] = sfdae_solve(problem, [0 1], 0, sfdae_options('rtol', 1e-9, 'parameters', struct('k', [1 4])));
assert(X(end), 4 * (1 - exp(-1)), 1e-6);

% Linear problems and events.
linear = sfdae_linear(1, @(t, p) -p.k, [], 'parameters', struct('k', 2));
events = @(t, x, xdot, p) deal(x - exp(-p.k / 2), 1, 0);
[T, ~] = sfdae_solve(linear, [0 3], 1, sfdae_options('rtol', 1e-9, 'atol', 1e-11, 'events', events));
assert(T(end), 0.5, 1e-7);
gravity = sfdae_options('parameters', struct('gravity', 1.62), 'rtol', 1e-8, 'atol', 1e-8);
sol = sfdae_solve(@pendulum_equations, [0 1], [0.6; -0.8; 0; 0; 0], gravity);
assert(sum(sol.y(3:4, end) .^ 2) / 2 + 1.62 * sol.y(2, end), -0.8 * 1.62, 1e-6);
end
