% SPDX-License-Identifier: BSD-3-Clause
function test_pendulum()
% The pendulum of differentiation index 3, in Cartesian coordinates with unknown force.
x0 = [0.6; -0.8; 0; 0; 0];
options = sfdae_options('rtol', 1e-8, 'atol', 1e-8);
sol = sfdae_solve(@(t, x, xd) pendulum_equations(t, x, xd), [0 10], x0, options);
assert(sol.status, 0);
assert([sol.strangeness_index, sol.d, sol.a, sol.u, sol.v], [2 2 3 0 0]);
assert(sol.x(1), 0);
assert(sol.x(end), 10);

% The angle phi from the downward vertical satisfies phi'' = -9.81 sin(phi), an ordinary differential equation.
angles = ode45(@(t, y) [y(2); -9.81 * sin(y(1))], [0 10], [atan2(0.6, 0.8); 0], ...
               odeset('RelTol', 1e-10, 'AbsTol', 1e-10));
phi = angles.y(end, 1);
if size(angles.y, 1) == 2
  phi = angles.y(1, end);     % MATLAB, and later versions of Octave
end
assert(sol.y(1:2, end), [sin(phi); -cos(phi)], 1e-6);

% All constraints hold, hidden ones included: q' q = 1, q' v = 0, and v' v = 2 s + 9.81 q_2 (differentiated twice).
q = sol.y(1:2, :);
v = sol.y(3:4, :);
assert(sum(q .^ 2), ones(1, size(q, 2)), 1e-13);
assert(sum(q .* v), zeros(1, size(q, 2)), 1e-12);
assert(sum(v .^ 2) - 9.81 * q(2, :), 2 * sol.y(5, :), 1e-10);
energy = sum(v .^ 2) / 2 + 9.81 * q(2, :);
assert(energy, energy(1) * ones(size(energy)), 1e-5);
assert(sol.xdot(1:2, :), v, 1e-4);

% Several outputs, and outputs at given times.
times = (0:0.5:10).';
[T, X] = sfdae_solve(@pendulum_equations, times, x0, options);
assert(T, times);
assert(size(X), [numel(times) 5]);
assert(X(end, :).', sol.y(:, end), 1e-6);
assert(sfdae_deval(sol, times).', X, 1e-5);

% Backward in time: the start is reached again.
[T, X] = sfdae_solve(@pendulum_equations, [10 0], sol.y(:, end), options);
assert(T(end), 0);
assert(X(end, 1:2), [0.6 -0.8], 1e-5);

% Every method.
for method = {'bdf', 'radau', 'automatic'}
  [~, X] = sfdae_solve(@pendulum_equations, [0 10], x0, sfdae_options(options, 'method', method{1}));
  assert(X(end, :).', sol.y(:, end), 1e-5);
end
end
