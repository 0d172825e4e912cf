% SPDX-License-Identifier: BSD-3-Clause
function p = multibody_form(problem, options)
% A mechanical system as sfdae_mex takes it: recorded, or with callbacks.
p.num_positions = problem.num_positions;
p.num_velocities = problem.num_velocities;
p.coordinates = coordinates_of(problem);
if isfield(problem, 'constraint_names')
  p.constraint_names = problem.constraint_names;
end
if options.record
  p.form = 'multibody_equations';
  [p.formulas, places] = recorded(@(t, q, v, values) written(problem, t, q, v, values, options.parameters), ...
                                  p.num_positions, p.num_velocities, options.parameters);
  for name = fieldnames(places).'
    p.(name{1}) = places.(name{1});
  end
  p.num_constraints = rows_of(p, 'constraints');
  p.num_nonholonomic = rows_of(p, 'nonholonomic_matrix');
else
  p = with_functions(p, problem, options);
end
p.num_unknowns = p.num_positions + p.num_velocities + p.num_constraints + p.num_nonholonomic;
p.num_equations = p.num_unknowns;
end

function k = coordinates_of(problem)
k = 0;
if isfield(problem, 'coordinates')
  k = find(strcmp(problem.coordinates, {'orthogonal', 'permutation'})) - 1;
  if isempty(k)
    error('sfdae:illegal_argument', 'sfdae_multibody: coordinates have to be ''orthogonal'' or ''permutation''');
  end
end
end

function count = rows_of(p, name)
count = 0;
if isfield(p, name) && strcmp(name, 'constraints')
  count = numel(p.(name));
elseif isfield(p, name)
  count = size(p.(name), 1);
end
end

function r = written(problem, t, q, v, values, parameters)
names = {'mass', 'forces', 'constraints', 'kinematics', 'nonholonomic_matrix', 'nonholonomic_offset'};
r = struct();
nq = problem.num_positions;
nv = problem.num_velocities;
for k = 1:numel(names)
  if ~isfield(problem, names{k}) || isempty(problem.(names{k}))
    continue
  end
  part = problem.(names{k});
  if is_function_handle(part)
    arguments = {t, q};
    if k == 2
      arguments = {t, q, v};
    end
    if takes_parameters(part, numel(arguments), parameters)
      arguments{end + 1} = values;
    end
    part = part(arguments{:});
  end
  r.(names{k}) = part;
end
if ~isfield(r, 'mass')
  r.mass = eye(nv);
end
if ~isfield(r, 'forces')
  r.forces = zeros(nv, 1);
end
check_size('M', r.mass, [nv nv]);
check_size('f', r.forces, [nv 1]);
if isfield(r, 'kinematics')
  check_size('kinematics', r.kinematics, [nq nv]);
end
if isfield(r, 'nonholonomic_matrix')
  check_size('nonholonomic_matrix', r.nonholonomic_matrix, [size(r.nonholonomic_matrix, 1) nv]);
end
end

function check_size(name, value, expected)
if ~isequal(size(value), expected) && ~(expected(2) == 1 && numel(value) == expected(1))
  error('sfdae:illegal_argument', 'sfdae_multibody: %s has size %s; it has to be %d x %d', name, ...
        mat2str(size(value)), expected(1), expected(2));
end
end

function p = with_functions(p, problem, options)
p.form = 'multibody';
names = {'mass', 'forces', 'constraints', 'constraint_jacobian', 'constraint_rate', 'kinematics', ...
         'nonholonomic_matrix', 'nonholonomic_offset', 'constraint_curvature', 'nonholonomic_curvature'};
counts = [2 3 2 2 2 2 2 2 3 3];
for k = 1:numel(names)
  if isfield(problem, names{k}) && ~isempty(problem.(names{k}))
    part = problem.(names{k});
    if is_function_handle(part)
      part = with_parameters(part, counts(k), options.parameters);
    else
      part = full(double(part));
    end
    p.(names{k}) = part;
  end
end
if ~isfield(p, 'forces')
  p.forces = zeros(p.num_velocities, 1);
end
if isfield(p, 'constraints') && ~isfield(p, 'constraint_jacobian')
  error('sfdae:illegal_argument', 'sfdae_multibody: constraint_jacobian is needed with record = false');
end
p.num_constraints = count_of(p, problem, 'constraints', 'num_constraints');
p.num_nonholonomic = count_of(p, problem, 'nonholonomic_matrix', 'num_nonholonomic');
end

function count = count_of(p, problem, name, given)
% Number of rows of a function: given, or counted at a point.
if isfield(problem, given)
  count = problem.(given);
elseif ~isfield(p, name)
  count = 0;
elseif is_function_handle(p.(name))
  count = size(p.(name)(0, ones(p.num_positions, 1)), 1);
else
  count = size(p.(name), 1);
end
end
