% SPDX-License-Identifier: BSD-3-Clause
function test_circuit()
% A source sin t with a capacitor parallel to it, and R, L, C in series (all 1): strangeness index 1, differentiation
% index 2. q = e3 solves q'' + q' + q = sin t, so all unknowns are known.
F = @(t, x, xdot) [xdot(1) + x(1) - x(2) + x(5); x(2) - x(1) + x(4); xdot(3) - x(4); xdot(4) - x(2) + x(3); ...
                   x(1) - sin(t)];
options = sfdae_options('fixed', [3 4], 'rtol', 1e-8, 'atol', 1e-8);
sol = sfdae_solve(F, linspace(0, 10, 21), [9; 9; 0; 0; 9], options);
assert([sol.strangeness_index, sol.d, sol.a], [1 2 3]);
assert(sol.y, exact(sol.x), 1e-6);
result = sfdae_analyze(F, 0, zeros(5, 1));
assert(result.differentiation_index, 2);
assert(sum(result.structure.differentiations), 1);     % the source is differentiated once

% The same as a linear problem of matrices.
E = zeros(5);
E([1 13 19]) = 1;
A = [-1 1 0 0 -1; 1 -1 0 -1 0; 0 0 0 1 0; 0 1 -1 0 0; -1 0 0 0 0];
problem = sfdae_linear(E, A, @(t) [0; 0; 0; 0; sin(t)]);
[T, X] = sfdae_solve(problem, linspace(0, 10, 21), [9; 9; 0; 0; 9], options);
assert(X.', exact(T.'), 1e-6);
end

function x = exact(t)
w = sqrt(0.75);
decay = exp(-t / 2);
q = -cos(t) + decay .* (cos(w * t) + sin(w * t) / (2 * w));
i = sin(t) - decay .* sin(w * t) / w;
x = [sin(t); sin(t) - i; q; i; -cos(t) - i];
end
