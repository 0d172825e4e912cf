% SPDX-License-Identifier: BSD-3-Clause
%
% Robertson's reaction with the conservation of mass as third equation, a stiff system of differentiation index 1:
%
%   y1' = -0.04 y1 + 1e4 y2 y3,   y2' = 0.04 y1 - 1e4 y2 y3 - 3e7 y2^2,   0 = y1 + y2 + y3 - 1
%
% Check: values at t = 0.4, 4, 40 that are published for other solvers.
F = @(t, y, yp) [yp(1) + 0.04 * y(1) - 1e4 * y(2) * y(3); ...
                 yp(2) - 0.04 * y(1) + 1e4 * y(2) * y(3) + 3e7 * y(2)^2; ...
                 y(1) + y(2) + y(3) - 1];
options = sfdae_options('rtol', 1e-6, 'atol', [1e-8 1e-12 1e-8], 'method', 'radau');
[T, Y] = sfdae_solve(F, [0 0.4 4 40], [1; 0; 0], options);
printf('t = %4.1f   y = %.5f %.4e %.5f\n', [T, Y].');
assert(max(abs(Y(2:end, 1) - [0.98517; 0.90552; 0.71583])) < 1e-5);

[T, Y] = sfdae_solve(F, [0, logspace(-6, 10, 200)], [1; 0; 0], options);
later = 2:numel(T);
semilogx(T(later), Y(later, 1), T(later), 1e4 * Y(later, 2), T(later), Y(later, 3));
legend('y1', '1e4 y2', 'y3');
xlabel('t');
