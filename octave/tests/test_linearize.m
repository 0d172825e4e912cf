% SPDX-License-Identifier: BSD-3-Clause
function test_linearize()
% Descriptor systems: matrices, poles, zeros, transfer functions, and the package control.
F = @(t, x, xdot, p) [xdot(1) - x(2); xdot(2) + x(1) + 0.2 * x(2) - p.force];
options = sfdae_options('parameters', struct('force', 0), 'inputs', 'force', 'outputs', 1);
system = sfdae_linearize(F, 0, [0; 0], options);
assert(system.E, eye(2), 1e-14);
assert(system.A, [0 1; -1 -0.2], 1e-14);
assert(system.B, [0; 1], 1e-14);
assert(system.C, [1 0]);
assert(system.D, 0);
poles = sfdae_poles(system);
assert(poles, [-0.1 + sqrt(0.99) * 1i; -0.1 - sqrt(0.99) * 1i], 1e-12);
s = [0, 1i, 2 + 1i];
assert(sfdae_transfer(system, s), 1 ./ (s .^ 2 + 0.2 * s + 1), 1e-12);

% A pencil with infinite eigenvalues: the pendulum at rest has the poles +- i sqrt(9.81).
rest = [0; -1; 0; 0; 4.905];
system = sfdae_linearize(@pendulum_equations, 0, rest);
poles = sfdae_poles(system);
assert(real(poles), [0; 0], 1e-9);
assert(abs(imag(poles)), sqrt(9.81) * [1; 1], 1e-9);

% Zeros; rows of outputs; linear problems; columns of inputs.
two = struct('E', eye(2), 'A', [-1 0; 0 -2], 'B', [1; 1], 'C', [2 -1], 'D', 0);
assert(sfdae_invariant_zeros(two), -3, 1e-12);
given = sfdae_options('input_columns', [1; 1], 'output_rows', [2 -1]);
system = sfdae_linearize(sfdae_linear(two.E, two.A), 0, [], given);
assert(system.A, two.A);
assert(system.B, two.B);
assert(system.C, two.C);

if isempty(which('dss')) && isempty(pkg('list', 'control'))
  printf('the package control is not installed: conversions are not tested\n');
  return
end
pkg('load', 'control');
sys = sfdae_to_dss(two);
[problem, back] = sfdae_from_dss(sys, @(t) sin(t));
assert(back.A, two.A, 1e-14);
[~, X] = sfdae_solve(problem, [0 1], [0; 0], sfdae_options('rtol', 1e-9, 'atol', 1e-9));
exact = @(a) (a * sin(1) - cos(1) + exp(-a)) / (a^2 + 1);     % x' = -a x + sin t
assert(X(end, :), [exact(1), exact(2)], 1e-7);
singular = sfdae_to_dss(struct('E', [1 0; 0 0], 'A', [-2 1; 1 -1], 'B', [1; 0], 'C', [1 0], 'D', 0));
[problem, back] = sfdae_from_dss(singular);
assert(back.E, [1 0; 0 0]);
assert(sfdae_poles(back), -1, 1e-12);
result = sfdae_analyze(problem, 0);
assert([result.d, result.a], [1 1]);
end
