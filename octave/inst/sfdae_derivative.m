% SPDX-License-Identifier: BSD-3-Clause
function r = sfdae_derivative(a, variable)
% sfdae_derivative  Partial derivative of a formula, within equations that are being recorded.
%
%   r = sfdae_derivative(a, variable)
%
% variable is t, an unknown, the derivative of an unknown, or a parameter, as passed to the function that writes
% equations. Arrays are extended as by operators: sfdae_derivative(lambda' * g, q) is the force of constraints g(q) = 0.
%
% Example:
%   function r = pendulum(t, x, xdot)
%     q = x(1:2);  v = x(3:4);  s = x(5);
%     g = sum(q .^ 2) - 1;
%     r = [xdot(1:2) - v; xdot(3:4) + [0; 9.81] + sfdae_derivative(s * g, q); g];
%   end
%   sol = sfdae_solve(@pendulum, [0 1], [0.6; -0.8; 0; 0; 0]);
%
% See also: sfdae_time_derivative, sfdae_expression
error('sfdae:not_recordable', ['sfdae_derivative differentiates formulas: it needs expressions, within equations ' ...
      'that are being recorded, not numbers']);
end
