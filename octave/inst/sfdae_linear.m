% SPDX-License-Identifier: BSD-3-Clause
function problem = sfdae_linear(E, A, f, varargin)
% sfdae_linear  Linear problem E(t) x' = A(t) x + f(t), of any index.
%
%   problem = sfdae_linear(E, A, f, 'name', value, ...)
%
% E and A are matrices (m x n, full or sparse) or functions E(t), A(t); f is a vector, a function f(t), or [] for 0.
% Functions are recorded and differentiated exactly. Properties:
%
%   parameters          struct of values: functions get them as one more argument, E(t, p)
%   record = false      functions of (t, order) return the derivative of that order at t in numbers, without factorials,
%                       or [] if it is not available (option difference_derivatives)
%   prescribed, prescribed_values, equation_names    see help sfdae_options
%
% Example (the first one of the documentation of GELDA; x = [(1 + t) exp(-t); exp(-t)]):
%   E = @(t) [0 0; 1 -t];
%   A = @(t) [-1 t; 0 0];
%   f = @(t) [exp(-t); 0];
%   [T, X] = sfdae_solve(sfdae_linear(E, A, f), [0 2], [5; -3]);
%   X(end, :) - [3 1] * exp(-2)     % roundoff
%
% See also: sfdae_solve, sfdae_from_dss
if nargin < 2
  error('sfdae:illegal_argument', 'sfdae_linear needs E and A');
end
if nargin < 3
  f = [];
end
names = {'parameters', 'record', 'prescribed', 'prescribed_values', 'equation_names'};
problem = properties_of('sfdae_linear', names, varargin);
problem.kind = 'linear';
problem.E = coefficient('E', E);
problem.A = coefficient('A', A);
problem.f = coefficient('f', f);
if isempty(E) || isempty(A)
  error('sfdae:illegal_argument', 'sfdae_linear: E and A must not be empty');
end
if isnumeric(E) && isnumeric(A) && ~isequal(size(E), size(A))
  error('sfdae:illegal_argument', 'sfdae_linear: E is %s and A is %s; they need the same size', ...
        mat2str(size(E)), mat2str(size(A)));
end
end

function value = coefficient(name, value)
if ~is_function_handle(value) && ~((isnumeric(value) || islogical(value)) && isreal(value) && ndims(value) == 2)
  error('sfdae:illegal_argument', 'sfdae_linear: %s has to be a real matrix or a function handle, not of class %s', ...
        name, class(value));
end
if ~is_function_handle(value) && any(~isfinite(value(:)))
  error('sfdae:illegal_argument', 'sfdae_linear: %s contains NaN or Inf', name);
end
end
