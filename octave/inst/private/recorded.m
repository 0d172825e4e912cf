% SPDX-License-Identifier: BSD-3-Clause
function [formulas, places] = recorded(write, num_x, num_xdot, parameters)
% Calls write(t, x, xdot, p) with expressions. write returns a struct of arrays of expressions or numbers; places has
% the numbers of their nodes in formulas, field by field.
depth = sfdae_mex('depth');
cleanup = onCleanup(@() sfdae_mex('drop', depth));
[t, x, xdot] = sfdae_mex('begin', num_x, num_xdot);
p = recorded_parameters(parameters);
try
  written = write(sfdae_expression(t), sfdae_expression(x), sfdae_expression(xdot), p);
catch err
  rethrow(explained(err));
end
names = fieldnames(written);
places = struct();
for k = 1:numel(names)
  value = written.(names{k});
  if ~isa(value, 'sfdae_expression') && ~((isnumeric(value) || islogical(value)) && isreal(value))
    error('sfdae:illegal_argument', '%s has to be an array of expressions or real numbers, not of class %s', ...
          names{k}, class(value));
  end
  places.(names{k}) = sfdae_mex('places', sfdae_nodes(value));
end
formulas = sfdae_mex('end');
end

function p = recorded_parameters(parameters)
p = parameters;
names = fieldnames(parameters);
for k = 1:numel(names)
  value = parameters.(names{k});
  ids = zeros(size(value), 'int64');
  for i = 1:numel(value)
    name = names{k};
    if numel(value) > 1
      name = sprintf('%s(%d)', name, i);
    end
    ids(i) = sfdae_mex('parameter', name, double(value(i)));
  end
  p.(names{k}) = sfdae_expression(ids);
end
end

function err = explained(err)
% Errors of Octave about values of class sfdae_expression say what to write instead.
known = { ...
  'no conversion for assignment', ['An array of numbers cannot hold expressions: begin with r = sfdae_zeros(m, n) ' ...
    'in place of zeros(m, n), or write r = [a; b].']; ...
  'for loop', 'A loop runs over numbers: write for k = 1:numel(x), and use x(k).'; ...
  ['argument ''class''|\(class, |, class\)|not defined for class|not defined for sfdae_expression|' ...
   'must be numeric floating point'], ...
    ['This function is not available for expressions (help sfdae_expression lists those that are). The option ' ...
     'record = false calls the equations with numbers instead (differentiation index 0 or 1).']};
if ~isempty(err.identifier) && isempty(regexp(err.identifier, '^(Octave|MATLAB):', 'once'))     % errors of the user
  return
end
for k = 1:size(known, 1)
  if ~isempty(regexp(err.message, known{k, 1}, 'once'))
    err = struct('message', sprintf('%s\n%s', err.message, known{k, 2}), 'identifier', 'sfdae:not_recordable', ...
                 'stack', err.stack);
    return
  end
end
end
