% SPDX-License-Identifier: BSD-3-Clause
function test_memory()
% The resident memory does not grow over repeated solutions, failures included.
if exist('/proc/self/statm', 'file') ~= 2
  printf('no /proc/self/statm: memory is not measured\n');
  return
end
for k = 1:30
  solve_all();
end
before = resident();
for k = 1:90
  solve_all();
end
growth = resident() - before;
printf('growth of 90 rounds: %d kB\n', growth);
assert(growth < 2000);     % a solver that is not freed takes more than 100 kB: 90 of them would show
end

function solve_all()
F = @(t, x, xdot) [xdot(1) - x(2); xdot(2) + x(1) + x(3); x(3) - sin(x(1))];
state = warning('off', 'all');
sol = sfdae_solve(F, [0 1], [1; 0; 0]);
sfdae_deval(sol, 0.5);
options = sfdae_options('record', false, 'events', @(t, x, xdot) deal(x(2) + 0.5, 0, 0), 'rtol', 1e-3, 'atol', 1e-3);
sfdae_solve(F, 0:0.1:0.3, [1; 0; 0], options);
sfdae_decic(F, 0, [1; 0; 0]);
sfdae_analyze(F, 0, [1; 0; 0]);
sfdae_poles(sfdae_linearize(F, 0, [0; 0; 0]));
wrong = {@() sfdae_solve(@(t, x, xdot) error('mine:id', 'mine'), [0 1], 1), ...
         @() sfdae_solve(@(t, x, xdot) error('mine:id', 'mine'), [0 1], 1, sfdae_options('record', false)), ...
         @() sfdae_solve(F, [0 1], [1; 2; 3], sfdae_options('rtol', -1)), ...
         @() sfdae_solve(@(t, x, xdot) [xdot; 1; 2], [0 1], 1, sfdae_options('record', false))};
for k = 1:numel(wrong)
  try
    wrong{k}();
    error('test:no_error', 'no error');
  catch err
    assert(~strcmp(err.identifier, 'test:no_error'));
  end
end
warning(state);
end

function kilobytes = resident()
text = fileread('/proc/self/statm');
pages = sscanf(text, '%d');
kilobytes = pages(2) * 4;
end
