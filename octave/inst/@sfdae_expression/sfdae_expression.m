% SPDX-License-Identifier: BSD-3-Clause
function r = sfdae_expression(id)
% sfdae_expression  Formulas in the unknowns of a problem that is being recorded.
%
% The functions that write equations get expressions as t, x and xdot. Operators and functions of expressions make
% longer expressions: + - * / .* ./ .^ ^, comparisons, & | ~, sin ... atanh, exp, log, sqrt, abs, min, max, sign,
% floor, mod, erf, ifelse, interp1, sum, prod, dot, cross, kron, norm, indexing, concatenation. A condition on an
% expression is written with ifelse: if, while, && and || need numbers.
%
% The constructor belongs to the package: sfdae_solve calls it.
%
% Example:
%   F = @(t, x, xdot) [xdot(1) + ifelse(x(1) > 1, x(1), 1); x(2) - sin(t)];
%   [T, X] = sfdae_solve(F, [0 1], [2; 0]);
%
% See also: sfdae_solve, sfdae_zeros, sfdae_table
if nargin ~= 1 || ~isa(id, 'int64')
  error('sfdae:illegal_argument', 'expressions are made by sfdae_solve, which passes them to the equations');
end
r = class(struct('id', id, 'is_condition', false), 'sfdae_expression');
superiorto('double', 'single', 'logical');
end
