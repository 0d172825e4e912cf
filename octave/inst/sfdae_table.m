% SPDX-License-Identifier: BSD-3-Clause
function r = sfdae_table(a, degree, x, y)
% sfdae_table  Spline through points, of a time or an unknown.
%
%   r = sfdae_table(a, degree, x, y)
%
% The value at a of the spline of degree 1, 3, 5 or 7 through the points (x(i), y(i)), x increasing, at least degree + 1
% of them. It has degree - 1 continuous derivatives ("not a knot"). If a depends on t alone, steps end at the knots.
% Evaluations outside of the data fail: for constant extrapolation write min(max(a, x(1)), x(end)) in place of a; for
% data of period P, mod(a - x(1), P) + x(1). Numbers allow the degrees 1 and 3 only.
%
% Example:
%   F = @(t, x, xdot) xdot - sfdae_table(t, 1, [0 1 2], [0 3 0]);
%   [T, X] = sfdae_solve(F, [0 2], 0);
%   X(end)     % 3, the area below the table
%
% See also: sfdae_expression, sfdae_solve
if nargin ~= 4
  error('sfdae:illegal_argument', 'sfdae_table needs four arguments: a, degree, x, y');
end
if isequal(degree, 1)
  r = interp1(x, y, a, 'linear');
elseif isequal(degree, 3)
  r = spline(x, y, a);
else
  error('sfdae:illegal_argument', 'sfdae_table: outside of recorded equations the degree has to be 1 or 3');
end
end
