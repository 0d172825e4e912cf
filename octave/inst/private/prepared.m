% SPDX-License-Identifier: BSD-3-Clause
function [p, o, options, x0] = prepared(caller, problem, x0, options)
% A problem as sfdae_mex takes it: p, with the options o of the library; options: all of them, those of the problem
% included; x0: start values as a column, [] if there are none.
if is_function_handle(problem)
  problem = sfdae_nonlinear(problem);
end
if ~isstruct(problem) || ~isscalar(problem) || ~isfield(problem, 'kind')
  error('sfdae:illegal_argument', ['%s: the problem has to be a function handle F(t, x, xdot), or what ' ...
        'sfdae_linear, sfdae_multibody or sfdae_nonlinear return, not of class %s'], caller, class(problem));
end
x0 = checked_start(caller, x0);
options = merged(problem, options);
options.record = ~isfield(options, 'record') || options.record;
if ~isfield(options, 'parameters')
  options.parameters = struct();
end
switch problem.kind
  case 'nonlinear'
    p = nonlinear_form(caller, problem, x0, options);
  case 'linear'
    p = linear_form(problem, options);
  case 'multibody'
    p = multibody_form(problem, options);
    count = p.num_positions + p.num_velocities;
    if numel(x0) == count
      x0 = [x0; zeros(p.num_unknowns - count, 1)];
    end
  otherwise
    error('sfdae:illegal_argument', '%s: unknown kind of problem ''%s''', caller, problem.kind);
end
if ~isempty(x0) && numel(x0) ~= p.num_unknowns
  error('sfdae:illegal_argument', '%s: x0 has %d values; the problem has %d unknowns', caller, numel(x0), ...
        p.num_unknowns);
end
p = with_properties(p, options);
o = library_options(options, p.num_unknowns);
end

function x0 = checked_start(caller, x0)
if isempty(x0)
  x0 = [];
  return
end
if ~(isnumeric(x0) && isreal(x0) && isvector(x0))
  error('sfdae:illegal_argument', '%s: x0 has to be a vector of real numbers, not of class %s and size %s', caller, ...
        class(x0), mat2str(size(x0)));
end
x0 = full(double(x0(:)));
bad = find(~isfinite(x0), 1);
if ~isempty(bad)
  error('sfdae:illegal_argument', '%s: x0(%d) is %g; use 0 as the initial guess of anything unknown', caller, bad, ...
        x0(bad));
end
end

function options = merged(problem, options)
% Properties of the problem that are options, too; those given as options replace them.
names = {'parameters', 'record', 'jacobian', 'pattern_x', 'pattern_xdot', 'equation_names', 'prescribed', ...
         'prescribed_values', 'differentiations'};
for k = 1:numel(names)
  if isfield(problem, names{k}) && ~isempty(problem.(names{k}))
    if ~isfield(options, names{k})
      checked = checked_options(struct(names{k}, {problem.(names{k})}));
      options.(names{k}) = checked.(names{k});
    elseif strcmp(names{k}, 'parameters')
      values = problem.parameters;
      for name = fieldnames(options.parameters).'
        values.(name{1}) = options.parameters.(name{1});
      end
      options.parameters = values;
    end
  end
end
end

function p = with_properties(p, options)
for name = {'equation_names', 'prescribed', 'prescribed_values', 'differentiations'}
  if isfield(options, name{1})
    p.(name{1}) = options.(name{1});
  end
end
if isfield(p, 'prescribed_values')
  p.prescribed_values = with_parameters(p.prescribed_values, 1, options.parameters);
end
if isfield(p, 'equation_names') && iscell(p.equation_names)
  p.equation_names = p.equation_names(:);
end
end
