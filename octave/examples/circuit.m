% SPDX-License-Identifier: BSD-3-Clause
%
% A source sin t with a capacitor C parallel to it, and R, L, C in series. Unknowns: the potentials e1, e2, e3, the
% currents iL and iV:
%
%   C e1' + (e1 - e2) / R + iV = 0,   (e2 - e1) / R + iL = 0,   C e3' = iL,   L iL' = e2 - e3,   e1 = sin t
%
% The capacitor at the source makes iV depend on (sin t)': differentiation index 2 (strangeness index 1). Check: for R =
% L = C = 1, q = e3 solves q'' + q' + q = sin t.
F = @(t, x, xdot, p) [p.C * xdot(1) + (x(1) - x(2)) / p.R + x(5); ...
                      (x(2) - x(1)) / p.R + x(4); ...
                      p.C * xdot(3) - x(4); ...
                      p.L * xdot(4) - x(2) + x(3); ...
                      x(1) - sin(t)];
options = sfdae_options('parameters', struct('R', 1, 'L', 1, 'C', 1), 'fixed', [3 4], 'rtol', 1e-8, 'atol', 1e-8);
[T, X] = sfdae_solve(F, linspace(0, 20, 201), zeros(5, 1), options);
w = sqrt(0.75);
q = -cos(T) + exp(-T / 2) .* (cos(w * T) + sin(w * T) / (2 * w));
printf('largest error of e3: %.1e\n', max(abs(X(:, 3) - q)));
assert(max(abs(X(:, 3) - q)) < 1e-6);

result = sfdae_analyze(F, 0, zeros(5, 1), options);
printf('strangeness index %d, d = %d, a = %d\n', result.strangeness_index, result.d, result.a);
plot(T, X(:, [1 3 5]));
legend('e1', 'e3', 'iV');
xlabel('t');
