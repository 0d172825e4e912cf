% SPDX-License-Identifier: BSD-3-Clause
function p = linear_form(problem, options)
% A linear problem as sfdae_mex takes it: recorded, or with callbacks.
parts = {problem.E, problem.A, problem.f};
if ~any(cellfun(@is_function_handle, parts)) || ~options.record
  p = form_of_numbers(problem, options);
  return
end
p.form = 'linear_equations';
[p.formulas, places] = recorded(@(t, x, xdot, v) written(problem, t, v, options.parameters), 0, 0, options.parameters);
[m, n] = size(places.E);
if ~isequal(size(places.A), [m, n])
  error('sfdae:illegal_argument', 'E is %d x %d and A is %s; they need the same size', m, n, mat2str(size(places.A)));
end
if isfield(places, 'f') && numel(places.f) ~= m
  error('sfdae:illegal_argument', 'f has %d entries; there are %d equations', numel(places.f), m);
end
p.E = places.E;
p.A = places.A;
if isfield(places, 'f')
  p.f = places.f(:);
end
p.num_equations = m;
p.num_unknowns = n;
% Zeros of numbers are left out, so that the library sees the structure.
zeros_of_numbers = p.formulas.op == number_operation() & p.formulas.value == 0;
p.E(zeros_of_numbers(p.E + 1)) = -1;
p.A(zeros_of_numbers(p.A + 1)) = -1;
end

function op = number_operation()
% The number of the operation that is a number: it is recorded once to find out.
persistent known
if isempty(known)
  depth = sfdae_mex('depth');
  cleanup = onCleanup(@() sfdae_mex('drop', depth));
  sfdae_mex('begin', 0, 0);
  place = sfdae_mex('places', 1);
  formulas = sfdae_mex('end');
  known = formulas.op(place + 1);
end
op = known;
end

function r = written(problem, t, values, parameters)
for name = {'E', 'A', 'f'}
  part = problem.(name{1});
  if is_function_handle(part)
    if takes_parameters(part, 1, parameters)
      part = part(t, values);
    else
      part = part(t);
    end
  end
  if ~isempty(part)
    r.(name{1}) = part;
  end
end
end

function p = form_of_numbers(problem, options)
p.form = 'linear';
for name = {'E', 'A', 'f'}
  part = problem.(name{1});
  if is_function_handle(part)
    part = with_parameters(part, 2, options.parameters);
  elseif ~isempty(part)
    part = full(double(part));
  end
  p.(name{1}) = part;
end
value = p.E;
if is_function_handle(value)
  value = p.A;
end
if is_function_handle(value)
  value = p.E(0, 0);     % for its size alone
end
[p.num_equations, p.num_unknowns] = size(value);
if isnumeric(p.f) && ~isempty(p.f) && numel(p.f) ~= p.num_equations
  error('sfdae:illegal_argument', 'f has %d entries; there are %d equations', numel(p.f), p.num_equations);
end
end
