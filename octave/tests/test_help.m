% SPDX-License-Identifier: BSD-3-Clause
function test_help()
% Every function has a help text with an example, and the examples run.
folder = fileparts(which('sfdae_solve'));
files = dir(fullfile(folder, 'sfdae_*.m'));
assert(numel(files) >= 20);
names = [{files.name}, {fullfile('@sfdae_expression', 'sfdae_expression.m')}];
set(0, 'defaultfigurevisible', 'off');
count = 0;
for k = 1:numel(names)
  [~, name] = fileparts(names{k});
  text = help_text(fullfile(folder, names{k}));
  assert(strncmp(text{1}, name, numel(name)), sprintf('%s: its help text begins with another name', name));
  code = example_of(text);
  assert(~isempty(code), sprintf('%s has no example', name));
  if ~isempty(strfind(strjoin(text), 'needs the package control')) && isempty(pkg('list', 'control'))
    continue
  elseif ~isempty(strfind(strjoin(text), 'needs the package control'))
    pkg('load', 'control');
  end
  run_example(name, code);
  count = count + 1;
end
printf('%d examples ran\n', count);
check_values();
end

function lines = help_text(file)
% The comment below the line `function`, or that before it.
all = strsplit(fileread(file), "\n");
first = find(strncmp(all, 'function', 8), 1) + 1;
last = first;
while last <= numel(all) && strncmp(all{last}, '%', 1)
  last = last + 1;
end
lines = cellfun(@(line) line(min(3, numel(line) + 1):end), all(first:last - 1), 'UniformOutput', false);
end

function code = example_of(text)
% The indented lines below `Example`.
code = {};
first = find(strncmp(text, 'Example', 7), 1);
if isempty(first)
  return
end
for k = first + 1:numel(text)
  if isempty(text{k})
    break
  end
  if strncmp(text{k}, '  ', 2)
    code{end + 1} = text{k}(3:end);
  end
end
end

function run_example(name, code)
% Runs an example as a script, in Octave's way: functions of it are defined first.
file = [tempname() '.m'];
handle = fopen(file, 'w');
fprintf(handle, '1;\n%s\n', strjoin(code, "\n"));
fclose(handle);
cleanup = onCleanup(@() delete(file));
state = warning('off', 'sfdae:note');
try
  evalc(sprintf('source(''%s'')', file));
catch err
  error('the example of %s: %s', name, err.message);
end
warning(state);
end

function check_values()
% Values that the help texts state.
assert(sfdae_poles(struct('E', [1 0; 0 0], 'A', [-2 1; 1 -1])), -1, 1e-12);
system = struct('E', 1, 'A', -2, 'B', 1, 'C', 1, 'D', 0);
assert(sfdae_transfer(system, [0 2i]), [0.5, 0.25 - 0.25i], 1e-12);
[~, X] = sfdae_solve(@(t, x, xdot) xdot - sfdae_table(t, 1, [0 1 2], [0 3 0]), [0 2], 0);
assert(X(end), 3, 1e-5);
x = sfdae_decic(@(t, x, xdot) [xdot(1) - x(2); x(1)^2 + x(2)^2 - 1], 0, [0.6; 0.7], 1);
assert(x, [0.6; 0.8], 1e-12);
end
