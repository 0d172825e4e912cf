% SPDX-License-Identifier: BSD-3-Clause
function test_examples()
% The examples run; they check their own answers.
set(0, 'defaultfigurevisible', 'off');
folder = fullfile(fileparts(fileparts(mfilename('fullpath'))), 'examples');
files = dir(fullfile(folder, '*.m'));
assert(numel(files) >= 3);
for k = 1:numel(files)
  printf('%s\n', files(k).name);
  run_script(fullfile(folder, files(k).name));
end
end

function run_script(file)
source(file);
end
