% SPDX-License-Identifier: BSD-3-Clause
function test_robertson()
% Robertson's reaction, recorded and with numbers. The values at t = 0.4, 4, 40 are those published with DASSL and IDA.
F = @(t, y, yp) [yp(1) + 0.04 * y(1) - 1e4 * y(2) * y(3); ...
                 yp(2) - 0.04 * y(1) + 1e4 * y(2) * y(3) + 3e7 * y(2)^2; ...
                 y(1) + y(2) + y(3) - 1];
published = [0.98517 3.3864e-05 0.01479; 0.90552 2.2405e-05 0.09446; 0.71583 9.1855e-06 0.28416];
options = sfdae_options('rtol', 1e-8, 'atol', [1e-8 1e-14 1e-8]);
[T, recorded] = sfdae_solve(F, [0 0.4 4 40], [1; 0; 0], options);
assert(T, [0; 0.4; 4; 40]);
check(recorded, published);
[~, numbers] = sfdae_solve(F, [0 0.4 4 40], [1; 0; 0], sfdae_options(options, 'record', false));
check(numbers, published);
assert(numbers, recorded, 1e-6);

% With a Jacobian, and with patterns for finite differences.
jacobian = @(t, y, yp) deal([0.04, -1e4 * y(3), -1e4 * y(2); -0.04, 1e4 * y(3) + 6e7 * y(2), 1e4 * y(2); 1 1 1], ...
                            diag([1 1 0]));
[~, exact] = sfdae_solve(F, [0 0.4 4 40], [1; 0; 0], sfdae_options(options, 'record', false, 'jacobian', jacobian));
check(exact, published);
patterns = sfdae_options(options, 'record', false, 'pattern_x', sparse(ones(3)), 'pattern_xdot', sparse(diag([1 1 0])));
[~, sparse_ones] = sfdae_solve(F, [0 0.4 4 40], [1; 0; 0], patterns);
check(sparse_ones, published);

% Conditions on values, which only numbers allow.
thermostat = @(t, x, xdot) xdot - heating(x) + 0.1 * (x - 15);
[~, X] = sfdae_solve(thermostat, [0 1], 10, sfdae_options('record', false));
assert(X(end), 15 + 50 + (10 - 65) * exp(-0.1), 1e-5);     % x' = 5 - 0.1 (x - 15) below 20
end

function check(values, published)
assert(max(max(abs(values(2:end, :) ./ published - 1))) < 4e-4);
assert(sum(values, 2), ones(4, 1), 1e-12);
end

function power = heating(x)
if x < 20
  power = 5;
else
  power = 0;
end
end
