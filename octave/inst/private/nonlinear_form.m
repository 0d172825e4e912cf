% SPDX-License-Identifier: BSD-3-Clause
function p = nonlinear_form(caller, problem, x0, options)
% A nonlinear problem as sfdae_mex takes it.
n = numel(x0);
if isfield(problem, 'num_unknowns')
  n = problem.num_unknowns;
end
if n == 0
  error('sfdae:illegal_argument', '%s: x0 is empty; it has to have a value for each unknown', caller);
end
p.num_unknowns = n;
if isfield(problem, 'total_derivative')
  p.form = 'residual';
  p.total_derivative = problem.total_derivative;
elseif options.record
  p.form = 'equations';
  [p.formulas, places] = recorded(@(t, x, xdot, v) written(problem.F, t, x, xdot, v, options.parameters), n, n, ...
                                  options.parameters);
  p.F = places.F(:);
  p.num_equations = numel(p.F);
else
  p.form = 'residual';
  p.residual = with_parameters(problem.F, 3, options.parameters);
  if isfield(options, 'jacobian')
    p.jacobian = with_parameters(options.jacobian, 3, options.parameters);
  end
end
if ~isfield(p, 'num_equations')
  p.num_equations = n;
  if isfield(problem, 'num_equations')
    p.num_equations = problem.num_equations;
  end
end
p = with_pattern(p, options, 'pattern_x', 'F_x');
p = with_pattern(p, options, 'pattern_xdot', 'F_xdot');
end

function r = written(F, t, x, xdot, values, parameters)
if takes_parameters(F, 3, parameters)
  r.F = F(t, x, xdot, values);
else
  r.F = F(t, x, xdot);
end
if isempty(r.F) || min(size(r.F)) ~= 1
  error('sfdae:illegal_argument', ...
        'F returned an array of size %s; it has to return a vector, one entry per equation', mat2str(size(r.F)));
end
end

function p = with_pattern(p, options, name, to)
if ~isfield(options, name)
  return
end
pattern = options.(name);
if ~isequal(size(pattern), [p.num_equations, p.num_unknowns])
  error('sfdae:illegal_argument', 'the option %s has size %s; it has to be %d x %d', name, mat2str(size(pattern)), ...
        p.num_equations, p.num_unknowns);
end
[rows, columns] = find(pattern);
p.([to '_rows']) = rows(:) - 1;
p.([to '_start']) = [0; cumsum(accumarray(columns(:), 1, [p.num_unknowns, 1]))];
end
