% SPDX-License-Identifier: BSD-3-Clause
function options = checked_options(given)
% Options with the names of this package, checked one by one; empty ones are left out.
options = struct();
names = fieldnames(given);
for k = 1:numel(names)
  value = given.(names{k});
  if ~isnumeric(value) || ~isempty(value)
    if ~(iscell(value) && isempty(value))
      name = option_name(names{k});
      options.(name) = checked_option(name, value);
    end
  end
end
end

function value = checked_option(name, value)
[names, kinds, choices] = option_names();
k = find(strcmp(name, names));
if k <= numel(kinds)
  value = checked_value(name, kinds{k}, choices{k}, value);
  return
end
switch name
  case {'monitor', 'jacobian', 'events', 'event_action', 'prescribed_values'}
    require(is_function_handle(value), name, 'a function handle', value);
  case {'record', 'dense'}
    require(isscalar(value) && (islogical(value) || isequal(value, 0) || isequal(value, 1)), name, ...
            'true or false', value);
    value = logical(value);
  case 'parameters'
    require(isstruct(value) && isscalar(value), name, 'a struct of numbers', value);
    cellfun(@(n) require(is_real(value.(n)) && all(isfinite(value.(n)(:))), ['parameters.' n], ...
            'finite real numbers', value.(n)), fieldnames(value));
  case 'equation_names'
    require(iscellstr(value), name, 'a cell array of texts', value);
  case {'sensitivities', 'inputs'}
    require(ischar(value) || iscellstr(value) || is_real(value), name, ...
            'names of parameters or numbers of unknowns', value);
    if ischar(value)
      value = {value};
    end
  case {'pattern_x', 'pattern_xdot'}
    require(issparse(value), name, 'a sparse matrix', value);
  otherwise
    require(is_real(value), name, 'an array of real numbers', value);
    value = full(double(value));
end
end

function value = checked_value(name, kind, choices, value)
% Options of the library: the ranges are checked there.
switch kind
  case 'c'
    require(ischar(value) && any(strcmpi(choices, value)), name, ['one of ''' strjoin(choices, ''', ''') ''''], value);
    value = lower(value);
  case 'f'
    require(is_real(value), name, 'numbers of unknowns, or true and false for each', value);
  otherwise
    is_vector = any(strcmp(name, {'rtol', 'atol', 'initial_weights'}));
    require(is_real(value) && (is_vector || isscalar(value)), name, 'a real number', value);
    value = full(double(value));
end
end

function result = is_real(value)
result = (isnumeric(value) || islogical(value)) && isreal(value) && ~isa(value, 'sfdae_expression');
end

function require(condition, name, what, value)
if ~condition
  if ischar(value)
    shown = ['''' value ''''];
  elseif isnumeric(value) && numel(value) <= 4
    shown = mat2str(value);
  else
    shown = sprintf('a value of class %s and size %s', class(value), mat2str(size(value)));
  end
  error('sfdae:illegal_argument', 'the option %s has to be %s, not %s', name, what, shown);
end
end
