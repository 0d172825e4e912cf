% SPDX-License-Identifier: BSD-3-Clause
function r = sfdae_table(a, degree, x, y)
% Spline through points, of an expression: see help sfdae_table.
if ~isnumeric(x) || ~isnumeric(y) || isa(x, 'sfdae_expression') || isa(y, 'sfdae_expression') || numel(x) ~= numel(y)
  error('sfdae:illegal_argument', 'sfdae_table: x and y have to be vectors of numbers of the same length');
end
table = struct('degree', double(degree), 'x', double(x(:)), 'y', double(y(:)));
r = sfdae_expression(sfdae_mex('table', operand(a), table));
end
