% SPDX-License-Identifier: BSD-3-Clause
function r = sfdae_time_derivative(a)
% sfdae_time_derivative  Total time derivative of a formula in t and x, which then contains xdot.
%
%   r = sfdae_time_derivative(a)
%
% The formula must not contain xdot.
%
% Example:
%   F = @(t, x, xdot) sfdae_time_derivative(x ^ 2) - 2 * x;      % (x^2)' = 2 x, so x = t + 1
%   [T, X] = sfdae_solve(F, [0 1], 1);
%   X(end)     % 2
%
% See also: sfdae_derivative, sfdae_expression
error('sfdae:not_recordable', ['sfdae_time_derivative differentiates formulas: it needs expressions, within ' ...
      'equations that are being recorded, not numbers']);
end
