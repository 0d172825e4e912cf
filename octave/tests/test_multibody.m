% SPDX-License-Identifier: BSD-3-Clause
function test_multibody()
% The pendulum as a mechanical system, recorded and with numbers, against the pendulum as equations.
x0 = [0.6; -0.8; 0; 0];
options = sfdae_options('rtol', 1e-8, 'atol', 1e-8);
[~, X] = sfdae_solve(@pendulum_equations, [0 3], [x0; 0], options);
expected = X(end, 1:4).';
f = @(t, q, v) [0; -9.81];
g = @(t, q) q(1)^2 + q(2)^2 - 1;
sol = sfdae_solve(sfdae_multibody(eye(2), f, g), [0 3], x0, options);
assert([sol.strangeness_index, sol.d, sol.a], [2 2 3]);
assert(sol.y(1:4, end), expected, 1e-6);
assert(sol.y(5, end), X(end, 5), 1e-5);     % G' lambda = 2 q lambda
numbers = sfdae_multibody(@(t, q) eye(2), f, g, 'num_positions', 2, 'record', false, ...
                          'constraint_jacobian', @(t, q) 2 * q.', 'constraint_curvature', @(t, q, v) 2 * (v.' * v));
sol = sfdae_solve(numbers, [0 3], x0, options);
assert(sol.y(1:4, end), expected, 1e-6);

% No constraints; parameters; the identity as mass matrix; permutation coordinates.
free = sfdae_multibody([], @(t, q, v, p) -p.k * q, [], 'num_positions', 1, 'parameters', struct('k', 4));
[~, X] = sfdae_solve(free, [0 1], [1; 0], options);
assert(X(end, 1), cos(2), 1e-6);
sol = sfdae_solve(sfdae_multibody(eye(2), f, g, 'coordinates', 'permutation'), [0 3], x0, options);
assert(sol.y(1:4, end), expected, 1e-6);

% A knife edge: sin(q3) v1 = cos(q3) v2 (nonholonomic). Without forces it moves on a circle with constant speed.
H = @(t, q) [sin(q(3)), -cos(q(3)), 0];
edge = sfdae_multibody(eye(3), @(t, q, v) zeros(3, 1), [], 'nonholonomic_matrix', H);
[~, X] = sfdae_solve(edge, [0 2], [0; 0; 0; 1; 0; 1], options);
assert(X(end, 1:3), [sin(2), 1 - cos(2), 2], 1e-6);
end
