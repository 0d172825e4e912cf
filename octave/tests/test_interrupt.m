% SPDX-License-Identifier: BSD-3-Clause
function test_interrupt()
% Ctrl-C (SIGINT) stops a run, which returns the part reached; the next run works.
if ~isunix()
  printf('signals are tested on Unix only\n');
  return
end
lastwarn('');
options = sfdae_options('max_steps', 1e9, 'rtol', 1e-10, 'dense', false);
for record = [true false]
  system(sprintf('(sleep 1; kill -INT %d) > /dev/null 2>&1 &', getpid()));
  F = @(t, x, xdot) [xdot(1) - x(2); xdot(2) + x(1)];
  [T, X] = sfdae_solve(F, [0 1e9], [1; 0], sfdae_options(options, 'record', record));
  assert(T(end) < 1e9 && numel(T) > 10);
  k = find(T < 10, 1, 'last');     % errors grow with time, and the run gets as far as the processor is fast
  assert(X(k, 1), cos(T(k)), 1e-5);
end
[~, id] = lastwarn();
assert(id, 'sfdae:stopped');
[~, X] = sfdae_solve(F, [0 1], [1; 0]);
assert(X(end, 1), cos(1), 1e-4);
end
