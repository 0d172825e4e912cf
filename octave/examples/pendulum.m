% SPDX-License-Identifier: BSD-3-Clause
%
% A point of mass 1 on a rod of length 1, in Cartesian coordinates with unknown rod force s:
%
%   p' = u,   q' = v,   u' = -2 p s,   v' = -2 q s - 9.81,   0 = p^2 + q^2 - 1
%
% Differentiation index 3 (strangeness index 2). Check: the energy is constant.
1;
function r = equations(t, x, xdot)
  p = x(1);  q = x(2);  u = x(3);  v = x(4);  s = x(5);
  r = [xdot(1) - u; xdot(2) - v; xdot(3) + 2 * p * s; xdot(4) + 2 * q * s + 9.81; p^2 + q^2 - 1];
end

sol = sfdae_solve(@equations, [0 10], [0.6; -0.8; 0; 0; 0], sfdae_options('rtol', 1e-8, 'atol', 1e-8));
energy = sum(sol.y(3:4, :) .^ 2) / 2 + 9.81 * sol.y(2, :);
printf('strangeness index %d, d = %d, a = %d; %d steps\n', sol.strangeness_index, sol.d, sol.a, sol.stats.steps);
printf('p = %.4f, q = %.4f, s = %.3f\n', sol.y([1 2 5], end));
assert(max(abs(energy + 0.8 * 9.81)) < 1e-5);

t = linspace(0, 10, 400);
x = sfdae_deval(sol, t);
plot(t, x(1, :), t, x(2, :), t, x(5, :) / 10);
legend('p', 'q', 's / 10');
xlabel('t');
