% SPDX-License-Identifier: BSD-3-Clause
function run_test(name)
% run_test  Runs one test and ends Octave with the status 0, or 1 after a failure, which is shown.
%
%   octave --no-gui --path <inst> --path <folder of sfdae_mex> --path <tests> --eval "run_test('pendulum')"
try
  warning('error', 'sfdae:internal');
  feval(['test_' name]);
  printf('%s: passed\n', name);
catch err
  printf('%s: failed: %s [%s]\n', name, err.message, err.identifier);
  for frame = err.stack.'
    printf('  %s, line %d\n', frame.name, frame.line);
  end
  exit(1);
end
end
