% SPDX-License-Identifier: BSD-3-Clause
function r = pendulum_equations(t, x, xdot, varargin)
% A point of mass 1 on a rod of length 1: positions x(1:2), velocities x(3:4), rod force x(5).
gravity = 9.81;
if nargin > 3
  gravity = varargin{1}.gravity;
end
r = [xdot(1:2) - x(3:4); ...
     xdot(3) + 2 * x(1) * x(5); ...
     xdot(4) + 2 * x(2) * x(5) + gravity; ...
     x(1)^2 + x(2)^2 - 1];
end
