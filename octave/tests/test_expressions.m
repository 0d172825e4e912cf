% SPDX-License-Identifier: BSD-3-Clause
function test_expressions()
% Each operation of expressions gives what it gives for numbers: unknowns are set equal to formulas of known unknowns.
value = [0.3; -1.7; 2.5];
scalars = {@(x) x(1) + x(2), @(x) 1 - x(3), @(x) 2 * x(1), @(x) x(1) / x(2), @(x) 2 ./ x(2), @(x) x(1) \ 3, ...
           @(x) x(3) ^ 2, @(x) x(3) ^ -1.5, @(x) 2 ^ x(2), @(x) x(2) .^ 3, @(x) -x(1), @(x) +x(1), ...
           @(x) sin(x(1)), @(x) cos(x(2)), @(x) tan(x(1)), @(x) asin(x(1)), @(x) acos(x(1)), @(x) atan(x(2)), ...
           @(x) atan2(x(2), x(1)), @(x) sinh(x(2)), @(x) cosh(x(1)), @(x) tanh(x(2)), @(x) asinh(x(2)), ...
           @(x) asinh(x(1)), @(x) acosh(x(3)), @(x) atanh(x(1)), @(x) sec(x(1)), @(x) csc(x(1)), @(x) cot(x(1)), ...
           @(x) exp(x(2)), @(x) expm1(x(1)), @(x) log(x(3)), @(x) log1p(x(1)), @(x) log2(x(3)), @(x) log10(x(3)), ...
           @(x) sqrt(x(3)), @(x) cbrt(x(2)), @(x) abs(x(2)), @(x) sign(x(2)), @(x) floor(x(2)), @(x) ceil(x(2)), ...
           @(x) fix(x(2)), @(x) round(x(2)), @(x) mod(x(2), 1), @(x) mod(x(3), -2), @(x) rem(x(2), 1), ...
           @(x) rem(x(3), 2), @(x) hypot(x(1), x(2)), @(x) min(x(1), x(2)), @(x) max(x(1), 2), @(x) max(x), ...
           @(x) min(x), @(x) erf(x(1)), @(x) erfc(x(2)), @(x) (x(1) > x(2)) + 0, @(x) (x(1) < 0) + 0, ...
           @(x) (x(1) >= 0.1) + 0, @(x) (x(1) <= 0.1) + 0, @(x) ((x(1) > 0) & (x(2) > 0)) + 0, ...
           @(x) ((x(1) > 0) | (x(2) > 0)) + 0, @(x) ~(x(1) > 0) + 0, @(x) xor(x(1) > 0, x(2) > 0) + 0, ...
           @(x) (x(2) & 1) + 0, @(x) merge(x(1) > 0, x(2), x(3)), @(x) ifelse(x(2) > 0, sqrt(x(2)), x(3)), ...
           @(x) sum(x), @(x) prod(x), @(x) mean(x), @(x) sumsq(x), @(x) dot(x, [1; 2; 3]), @(x) dot(x, x), ...
           @(x) norm(x), @(x) norm(x, 1), @(x) norm(x, Inf), @(x) x' * x, @(x) [1 2 3] * x, @(x) x(end), ...
           @(x) numel(x) * x(1), @(x) length(x) * x(1), @(x) size(x, 1) + x(1), @(x) trace(x * x'), ...
           @(x) polyval([1 2 3], x(1)), @(x) interp1([0 1 2 3], [0 2 1 5], x(3)), ...
           @(x) interp1([0 1 2 3], [0 2 1 5], x(3), 'spline'), @(x) sfdae_table(x(3), 3, [0 1 2 3], [0 2 1 5]), ...
           @(x) deg2rad(x(1)), @(x) rad2deg(x(1)), @(x) true * x(1), ...
           @(x) sparse(2) * x(1), @(x) x(1) + real(x(2)), @(x) conj(x(3)), @(x) last(x(:))};
expected = cellfun(@(fn) double(fn(value)), scalars).';
F = @(t, x, xdot) [x(1:3) - value; x(4:end) - all_of(scalars, x(1:3))];
state = warning('off', 'sfdae:note');
x = sfdae_decic(F, 0, [value; expected + 0.1]);
warning(state);
check(x(4:end), expected, scalars);

arrays = {@(x) 2 * x, @(x) x .* x, @(x) x * x', @(x) magic(3) * x, @(x) (x' * magic(3))', @(x) magic(3) \ x, ...
          @(x) (x' / magic(3))', @(x) [x; 1; 2], @(x) [1; x], @(x) [x', 1]', @(x) [0 0; 1 x(1)], @(x) [x x], ...
          @(x) vertcat(x, x), @(x) cat(2, x, x), @(x) cross(x, [1; 2; 3]), @(x) cross([1; 2; 3], x), ...
          @(x) kron([1 2; 3 4], x), @(x) kron(x, x'), @(x) x(2:3), @(x) x([3 1 2]), @(x) x(logical([1; 0; 1])), ...
          @(x) x(end:-1:1), @(x) cumsum(x), @(x) diff(x), @(x) diff(x, 2), @(x) sum(x * x'), @(x) sum(x * x', 2), ...
          @(x) diag(x), @(x) diag(x * x'), @(x) reshape(x * x', 1, 9), @(x) repmat(x, 2, 2), @(x) flipud(x), ...
          @(x) circshift(x, 1), @(x) (x * x')(2, :), @(x) max(x, [1; 0; 3]), @(x) ifelse(x > 0, x, -x), ...
          @(x) x + [1 2 3], @(x) (x * x') ^ 2, @(x) prod(x * x', 2), @(x) min(x * x'), @(x) max(x * x', [], 2), ...
          @(x) atan2(x, [1; 2; 3]), @(x) assigned(x), @(x) x.', @(x) speye(3) * x, @(x) fliplr(x'), @(x) hypot(x, 1)};
for k = 1:numel(arrays)
  wanted = double(arrays{k}(value));
  F = @(t, x, xdot) [x(1:3) - value; x(4:end) - shaped(arrays{k}(x(1:3)), size(wanted))];
  state = warning('off', 'sfdae:note');
  x = sfdae_decic(F, 0, [value; wanted(:) + 0.1]);
  warning(state);
  check(x(4:end), wanted(:), arrays(k));
end

% Derivatives of formulas, and derivatives of all orders of erf: x' of an equation that is differentiated.
sol = sfdae_solve(@(t, x, xdot) sfdae_time_derivative(x ^ 2) - 2 * x, [0 1], 1, sfdae_options('rtol', 1e-9));
assert(sol.y(end), 2, 1e-6);
F = @(t, x, xdot) [x(1) - sin(t); x(2) - sfdae_derivative(x(1)^3, x(1))];
[~, X] = sfdae_solve(F, [0 1], [0; 0]);
assert(X(end, 2), 3 * sin(1)^2, 1e-9);
sol = sfdae_solve(@(t, x, xdot) [x(1) - erf(t); x(2) - xdot(1); x(3) - xdot(2)], [0 1], [0; 2 / sqrt(pi); 0]);
slope = 2 / sqrt(pi) * exp(-1);
assert(sol.y(:, end), [erf(1); slope; -2 * slope], 1e-9);
assert(sol.strangeness_index, 2);

% Structure: zeros of matrices of numbers make no dependence.
result = sfdae_analyze(@(t, x, xdot) [1 0; 0 1] * xdot + [1 0; 0 2] * x, 0, [1; 1]);
assert(result.structure.num_blocks, 2);
end

function r = all_of(functions, x)
r = sfdae_zeros(numel(functions), 1);
for k = 1:numel(functions)
  r(k) = functions{k}(x);
end
end

function r = shaped(r, expected)
assert(size(r), expected);
r = r(:);
end

function r = last(x)
r = x(end, 1);
end

function r = assigned(x)
r = sfdae_zeros(2, 2);
r(1, :) = [x(1) 5];
r(2, 2) = x(3);
r(1, 2) += x(2);
r(:, 1) = [];
end

function check(found, expected, functions)
bad = find(~(abs(found - expected) <= 1e-12 * (1 + abs(expected))), 1);
if ~isempty(bad)
  error('%s gives %.17g, not %.17g', func2str(functions{min(bad, numel(functions))}), found(bad), expected(bad));
end
end
