% SPDX-License-Identifier: BSD-3-Clause
function test_linear()
% The first example of the documentation of GELDA: x = [(1 + t) exp(-t); exp(-t)], strangeness index 1, d = 0.
exact = @(t) [(1 + t) .* exp(-t), exp(-t)];
warning('off', 'sfdae:note');     % the start values are adjusted
problem = sfdae_linear(@(t) [0 0; 1 -t], @(t) [-1 t; 0 0], @(t) [exp(-t); 0]);
sol = sfdae_solve(problem, [0 2], [5; -3]);
assert([sol.strangeness_index, sol.d, sol.a], [1 0 2]);
[T, X] = sfdae_solve(problem, 0:0.25:2, [5; -3]);
assert(X, exact(T), 1e-12);     % an algebraic solution: roundoff

% Callbacks of numbers with derivatives, which give the same to the digits of the C library.
numbers = sfdae_linear(@E_of_order, @A_of_order, @f_of_order, 'record', false);
[T, Y] = sfdae_solve(numbers, 0:0.25:2, [5; -3]);
assert(Y, exact(T), 1e-12);
result = sfdae_analyze(numbers, 0);
assert([result.strangeness_index, result.d, result.a, result.u, result.v], [1 0 2 0 0]);
assert(result.smallest_gap > 1e3);

% Derivatives by finite differences, if they are not available.
no_derivatives = sfdae_linear(@(t, k) at_order_0(k, [0 0; 1 -t]), @(t, k) at_order_0(k, [-1 t; 0 0]), ...
                              @(t, k) at_order_0(k, [exp(-t); 0]), 'record', false);
[T, Z] = sfdae_solve(no_derivatives, 0:0.25:2, [5; -3], sfdae_options('difference_derivatives', 1));
assert(Z, exact(T), 1e-6);

% Constant matrices alone, full and sparse; and an input that is prescribed.
[~, X] = sfdae_solve(sfdae_linear(1, -2), [0 1], 1, sfdae_options('rtol', 1e-8, 'atol', 1e-10));
assert(X(end), exp(-2), 1e-7);
[~, X] = sfdae_solve(sfdae_linear(speye(2), -speye(2), [1; 2]), [0 1], [0; 0], sfdae_options('rtol', 1e-8));
assert(X(end, :), [1 2] * (1 - exp(-1)), 1e-5);
free = sfdae_linear([1 0], [-1 1], [], 'prescribed', 2, 'prescribed_values', @(t) 3);
[~, X] = sfdae_solve(free, [0 1], [0; 3], sfdae_options('rtol', 1e-8));
assert(X(end, :), [3 * (1 - exp(-1)), 3], 1e-5);
end

function value = at_order_0(order, value)
if order > 0
  value = [];
end
end

function value = E_of_order(t, order)
value = zeros(2);
if order == 0
  value = [0 0; 1 -t];
elseif order == 1
  value = [0 0; 0 -1];
end
end

function value = A_of_order(t, order)
value = zeros(2);
if order == 0
  value = [-1 t; 0 0];
elseif order == 1
  value = [0 1; 0 0];
end
end

function value = f_of_order(t, order)
value = [(-1)^order * exp(-t); 0];
end
