/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Problems: structs of Octave converted to those of the library, and callbacks that are called at every point. The
 * struct has the field `form`: equations, linear_equations, multibody_equations (recorded), residual, linear or
 * multibody. */
#include <stdio.h>
#include <string.h>

#include "sfdae_mex.h"

/* Places of functions in problem.functions. */
enum { RESIDUAL, JACOBIAN, TOTAL_DERIVATIVE };
enum { MATRIX_E, MATRIX_A, VECTOR_F };
enum {
  MASS,
  FORCES,
  CONSTRAINTS,
  CONSTRAINT_JACOBIAN,
  CONSTRAINT_RATE,
  KINEMATICS,
  NONHOLONOMIC_MATRIX,
  NONHOLONOMIC_OFFSET,
  CONSTRAINT_CURVATURE,
  NONHOLONOMIC_CURVATURE
};

/* Calls a function, or reads an array given in its place. */
static int evaluate(const problem* p, int which, const char* name, size_t rows, size_t columns, int nin, mxArray** in,
                    double* result) {
  const mxArray* function = p->functions[which];
  mxArray* out = NULL;
  int i, status;
  if (!mxIsClass(function, "function_handle")) {
    for (i = 0; i < nin; ++i) mxDestroyArray(in[i]);
    return take_numbers(p->calls, mxDuplicateArray(function), rows, columns, name, result);
  }
  status = call_function(p->calls, function, 1, &out, nin, in);
  if (status != 0) return status;
  return take_numbers(p->calls, out, rows, columns, name, result);
}

/* ---- Linear problems -------------------------------------------------------------------------- */

static int call_coefficient(const problem* p, int which, const char* name, double t, int order, size_t rows,
                            size_t columns, double* result) {
  const mxArray* function = p->functions[which];
  mxArray *in[2], *out = NULL;
  int status;
  if (function == NULL) return 0;
  if (!mxIsClass(function, "function_handle")) {
    return order > 0 ? 0 : take_numbers(p->calls, mxDuplicateArray(function), rows, columns, name, result);
  }
  in[0] = mxCreateDoubleScalar(t);
  in[1] = mxCreateDoubleScalar(order);
  status = call_function(p->calls, function, 1, &out, 2, in);
  if (status != 0) return status;
  if (order > 0 && out != NULL && mxIsEmpty(out)) {
    mxDestroyArray(out);
    return SFDAE_ORDER_NOT_AVAILABLE;
  }
  return take_numbers(p->calls, out, rows, columns, name, result);
}

static int call_E(double t, int order, double* matrix, void* user) {
  const problem* p = (const problem*)user;
  return call_coefficient(p, MATRIX_E, "E", t, order, (size_t)p->num_equations, (size_t)p->num_unknowns, matrix);
}

static int call_A(double t, int order, double* matrix, void* user) {
  const problem* p = (const problem*)user;
  return call_coefficient(p, MATRIX_A, "A", t, order, (size_t)p->num_equations, (size_t)p->num_unknowns, matrix);
}

static int call_f(double t, int order, double* vector, void* user) {
  const problem* p = (const problem*)user;
  return call_coefficient(p, VECTOR_F, "f", t, order, (size_t)p->num_equations, 1, vector);
}

static int call_prescribed(double t, int order, double* vector, void* user) {
  const problem* p = (const problem*)user;
  mxArray *in[1], *out = NULL;
  int status;
  (void)order;
  in[0] = mxCreateDoubleScalar(t);
  status = call_function(p->calls, p->prescribed_values, 1, &out, 1, in);
  if (status != 0) return status;
  return take_numbers(p->calls, out, (size_t)p->num_prescribed, 1, "prescribed_values", vector);
}

/* ---- Nonlinear problems ----------------------------------------------------------------------- */

static int call_total_derivative(double t, int order, const double* derivatives, double* F, double* F_x,
                                 double* F_xdot, void* user) {
  const problem* p = (const problem*)user;
  const size_t m = (size_t)p->num_equations, n = (size_t)p->num_unknowns;
  const int all = p->functions[TOTAL_DERIVATIVE] != NULL;
  mxArray *in[4], *out[3] = {NULL, NULL, NULL};
  int status;
  if (all) {
    const int nout = F_x == NULL ? 1 : 3;
    in[0] = mxCreateDoubleScalar(t);
    in[1] = mxCreateDoubleScalar(order);
    in[2] = matrix_of(derivatives, n, (size_t)order + 2);
    status = call_function(p->calls, p->functions[TOTAL_DERIVATIVE], nout, out, 3, in);
    if (status != 0) return status;
    if (order > 0 && out[0] != NULL && mxIsEmpty(out[0])) {
      int i;
      for (i = 0; i < nout; ++i) {
        if (out[i] != NULL) mxDestroyArray(out[i]);
      }
      return SFDAE_ORDER_NOT_AVAILABLE;
    }
    status = take_numbers(p->calls, out[0], m, 1, "F of total_derivative", F);
  } else {
    if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
    in[0] = mxCreateDoubleScalar(t);
    in[1] = column_of(derivatives, n);
    in[2] = column_of(derivatives + n, n);
    status = evaluate(p, RESIDUAL, "F", m, 1, 3, in, F);
    if (status != 0 || F_x == NULL) return status;
    in[0] = mxCreateDoubleScalar(t);
    in[1] = column_of(derivatives, n);
    in[2] = column_of(derivatives + n, n);
    status = call_function(p->calls, p->functions[JACOBIAN], 2, out + 1, 3, in);
    if (status != 0) return status;
  }
  if (F_x == NULL) return status;
  if (take_numbers(p->calls, out[1], m, n, "F_x", F_x) != 0) status = -1;
  if (take_numbers(p->calls, out[2], m, n, "F_xdot", F_xdot) != 0) status = -1;
  return status;
}

/* ---- Mechanical systems ----------------------------------------------------------------------- */

static int call_at_positions(const problem* p, int which, const char* name, size_t rows, size_t columns, double t,
                             const double* q, double* result) {
  mxArray* in[2];
  in[0] = mxCreateDoubleScalar(t);
  in[1] = column_of(q, (size_t)p->num_positions);
  return evaluate(p, which, name, rows, columns, 2, in, result);
}

static int call_at_velocities(const problem* p, int which, const char* name, size_t rows, double t, const double* q,
                              const double* v, double* result) {
  mxArray* in[3];
  in[0] = mxCreateDoubleScalar(t);
  in[1] = column_of(q, (size_t)p->num_positions);
  in[2] = column_of(v, (size_t)p->num_velocities);
  return evaluate(p, which, name, rows, 1, 3, in, result);
}

#define AT_POSITIONS(function, which, name, rows, columns)                                     \
  static int function(double t, const double* q, double* result, void* user) {                 \
    const problem* p = (const problem*)user;                                                   \
    return call_at_positions(p, which, name, (size_t)(rows), (size_t)(columns), t, q, result); \
  }
#define AT_VELOCITIES(function, which, name, rows)                                              \
  static int function(double t, const double* q, const double* v, double* result, void* user) { \
    const problem* p = (const problem*)user;                                                    \
    return call_at_velocities(p, which, name, (size_t)(rows), t, q, v, result);                 \
  }

AT_POSITIONS(call_mass, MASS, "mass", p->num_velocities, p->num_velocities)
AT_VELOCITIES(call_forces, FORCES, "forces", p->num_velocities)
AT_POSITIONS(call_constraints, CONSTRAINTS, "constraints", p->num_constraints, 1)
AT_POSITIONS(call_constraint_jacobian, CONSTRAINT_JACOBIAN, "constraint_jacobian", p->num_constraints,
             p->num_positions)
AT_POSITIONS(call_constraint_rate, CONSTRAINT_RATE, "constraint_rate", p->num_constraints, 1)
AT_POSITIONS(call_kinematics, KINEMATICS, "kinematics", p->num_positions, p->num_velocities)
AT_POSITIONS(call_H, NONHOLONOMIC_MATRIX, "nonholonomic_matrix", p->num_nonholonomic, p->num_velocities)
AT_POSITIONS(call_h, NONHOLONOMIC_OFFSET, "nonholonomic_offset", p->num_nonholonomic, 1)
AT_VELOCITIES(call_gamma, CONSTRAINT_CURVATURE, "constraint_curvature", p->num_constraints)
AT_VELOCITIES(call_eta, NONHOLONOMIC_CURVATURE, "nonholonomic_curvature", p->num_nonholonomic)

/* ---- Structs ---------------------------------------------------------------------------------- */

/* A function handle, or an array of numbers if allowed. */
static const mxArray* function_in(const mxArray* from, const char* name, int may_be_array) {
  const mxArray* value = field_of(from, name);
  if (value == NULL || mxIsClass(value, "function_handle")) return value;
  if (!may_be_array || !mxIsDouble(value) || mxIsComplex(value) || mxIsSparse(value)) {
    refuse("%s has to be a function handle%s", name, may_be_array ? " or a real matrix" : "");
  }
  return value;
}

static int size_in(const mxArray* from, const char* name, long missing) {
  const long size = integer_in(from, name, missing);
  if (size < 0 || size > 50000) refuse("%s is %ld; it has to be 0 ... 50000", name, size);
  return (int)size;
}

/* Column starts and rows of a pattern, which count from 0. */
static void read_pattern(const mxArray* from, const char* start_name, const char* row_name, int n, int m,
                         int* entries, const int** starts, const int** rows) {
  const size_t count = length_of(from, row_name);
  size_t i;
  *entries = (int)count;
  *starts = integers_in(from, start_name, (size_t)n + 1, 0);
  *rows = integers_in(from, row_name, count, 0);
  if (*starts != NULL && *rows == NULL) *rows = (int*)mxCalloc(1, sizeof(int));
  for (i = 0; i < count; ++i) {
    if ((*rows)[i] < 0 || (*rows)[i] >= m) refuse("%s: row %d of %d", row_name, (*rows)[i] + 1, m);
  }
}

static const char* const* equation_names_in(const mxArray* from, const char* name, int expected) {
  int count;
  const char** names = texts_in(from, name, &count);
  if (names != NULL && count != expected) refuse("%s has %d names for %d equations", name, count, expected);
  return names;
}

static void read_linear(problem* p, const mxArray* from, int is_recorded) {
  const size_t size = (size_t)p->num_equations * (size_t)p->num_unknowns;
  if (is_recorded) {
    sfdae_nonlinear_problem* to = &p->as.nonlinear;
    p->kind = NONLINEAR;
    p->outputs[0] = read_nodes(from, "E", &p->formulas, size);
    p->outputs[1] = read_nodes(from, "A", &p->formulas, size);
    p->outputs[2] = read_nodes(from, "f", &p->formulas, (size_t)p->num_equations);
    sfdae_nonlinear_problem_init(to, sizeof *to);
    to->linear_equations = call_linear_equations;
  } else {
    sfdae_linear_problem* to = &p->as.linear;
    p->kind = LINEAR;
    sfdae_linear_problem_init(to, sizeof *to);
    p->functions[MATRIX_E] = function_in(from, "E", 1);
    p->functions[MATRIX_A] = function_in(from, "A", 1);
    p->functions[VECTOR_F] = function_in(from, "f", 1);
    if (p->functions[MATRIX_E] == NULL || p->functions[MATRIX_A] == NULL) refuse("a linear problem needs E and A");
    to->E = call_E, to->A = call_A;
    if (p->functions[VECTOR_F] != NULL) to->f = call_f;
    to->constant_E = !mxIsClass(p->functions[MATRIX_E], "function_handle");
    to->constant_A = !mxIsClass(p->functions[MATRIX_A], "function_handle");
    to->num_equations = p->num_equations, to->num_unknowns = p->num_unknowns;
    to->num_prescribed = p->num_prescribed;
    to->prescribed = integers_in(from, "prescribed", (size_t)p->num_prescribed, 1);
    if (p->num_prescribed > 0) to->prescribed_values = call_prescribed;
    to->equation_names = equation_names_in(from, "equation_names", p->num_equations);
    to->user = p;
  }
}

static void read_nonlinear(problem* p, const mxArray* from, int is_recorded) {
  sfdae_nonlinear_problem* to = &p->as.nonlinear;
  p->kind = NONLINEAR;
  sfdae_nonlinear_problem_init(to, sizeof *to);
  if (is_recorded) {
    p->outputs[0] = read_nodes(from, "F", &p->formulas, (size_t)p->num_equations);
    if (p->outputs[0] == NULL) refuse("equations are missing");
    to->equations = call_equations;
    to->differentiations = integers_in(from, "differentiations", (size_t)p->num_equations, 0);
    return;
  }
  p->functions[RESIDUAL] = function_in(from, "residual", 0);
  p->functions[JACOBIAN] = function_in(from, "jacobian", 0);
  p->functions[TOTAL_DERIVATIVE] = function_in(from, "total_derivative", 0);
  if (p->functions[RESIDUAL] == NULL && p->functions[TOTAL_DERIVATIVE] == NULL) refuse("the function F is missing");
  to->total_derivative = call_total_derivative;
  if (p->functions[JACOBIAN] == NULL && p->functions[TOTAL_DERIVATIVE] == NULL)
    to->matrices = SFDAE_MATRICES_DIFFERENCES;
  to->differentiations = integers_in(from, "differentiations", (size_t)p->num_equations, 0);
  read_pattern(from, "F_x_start", "F_x_rows", p->num_unknowns, p->num_equations, &to->F_x_entries, &to->F_x_col_start,
               &to->F_x_row_index);
  read_pattern(from, "F_xdot_start", "F_xdot_rows", p->num_unknowns, p->num_equations, &to->F_xdot_entries,
               &to->F_xdot_col_start, &to->F_xdot_row_index);
}

static void finish_nonlinear(problem* p, const mxArray* from) {
  sfdae_nonlinear_problem* to = &p->as.nonlinear;
  to->num_equations = p->num_equations, to->num_unknowns = p->num_unknowns;
  to->num_prescribed = p->num_prescribed;
  to->prescribed = integers_in(from, "prescribed", (size_t)p->num_prescribed, 1);
  if (p->num_prescribed > 0) to->prescribed_values = call_prescribed;
  to->equation_names = equation_names_in(from, "equation_names", p->num_equations);
  to->user = p;
}

static void read_multibody_formulas(problem* p, const mxArray* from) {
  const size_t nq = (size_t)p->num_positions, nv = (size_t)p->num_velocities;
  const size_t nl = (size_t)p->num_constraints, nk = (size_t)p->num_nonholonomic;
  p->outputs[0] = read_nodes(from, "mass", &p->formulas, nv * nv);
  p->outputs[1] = read_nodes(from, "forces", &p->formulas, nv);
  p->outputs[2] = read_nodes(from, "constraints", &p->formulas, nl);
  p->outputs[3] = read_nodes(from, "kinematics", &p->formulas, nq * nv);
  p->outputs[4] = read_nodes(from, "nonholonomic_matrix", &p->formulas, nk * nv);
  p->outputs[5] = read_nodes(from, "nonholonomic_offset", &p->formulas, nk);
  p->as.multibody.equations = call_multibody_equations;
}

static void read_multibody_functions(problem* p, const mxArray* from) {
  static const char* const names[10] = {"mass",
                                        "forces",
                                        "constraints",
                                        "constraint_jacobian",
                                        "constraint_rate",
                                        "kinematics",
                                        "nonholonomic_matrix",
                                        "nonholonomic_offset",
                                        "constraint_curvature",
                                        "nonholonomic_curvature"};
  sfdae_multibody_problem* to = &p->as.multibody;
  const mxArray** has = p->functions;
  int i;
  for (i = 0; i < 10; ++i) has[i] = function_in(from, names[i], 1);
  if (has[MASS] != NULL) to->mass = call_mass;
  if (has[FORCES] != NULL) to->forces = call_forces;
  if (has[CONSTRAINTS] != NULL) to->constraints = call_constraints;
  if (has[CONSTRAINT_JACOBIAN] != NULL) to->constraint_jacobian = call_constraint_jacobian;
  if (has[CONSTRAINT_RATE] != NULL) to->constraint_rate = call_constraint_rate;
  if (has[KINEMATICS] != NULL) to->kinematics = call_kinematics;
  if (has[NONHOLONOMIC_MATRIX] != NULL) to->nonholonomic_matrix = call_H;
  if (has[NONHOLONOMIC_OFFSET] != NULL) to->nonholonomic_offset = call_h;
  if (has[CONSTRAINT_CURVATURE] != NULL) to->constraint_curvature = call_gamma;
  if (has[NONHOLONOMIC_CURVATURE] != NULL) to->nonholonomic_curvature = call_eta;
}

static void read_multibody(problem* p, const mxArray* from, int is_recorded) {
  sfdae_multibody_problem* to = &p->as.multibody;
  p->kind = MULTIBODY;
  sfdae_multibody_problem_init(to, sizeof *to);
  if (is_recorded) read_multibody_formulas(p, from);
  else read_multibody_functions(p, from);
  to->num_positions = p->num_positions, to->num_velocities = p->num_velocities;
  to->num_constraints = p->num_constraints, to->num_nonholonomic = p->num_nonholonomic;
  to->coordinates = (int)integer_in(from, "coordinates", SFDAE_COORDINATES_ORTHOGONAL);
  to->constraint_names = equation_names_in(from, "constraint_names", p->num_constraints + p->num_nonholonomic);
  to->user = p;
}

problem* read_problem(const mxArray* from) {
  problem* p = (problem*)mxCalloc(1, sizeof *p);
  const char* form = text_in(from, "form");
  const int is_recorded = strstr(form, "equations") != NULL, is_multibody = strncmp(form, "multibody", 9) == 0;
  p->num_positions = size_in(from, "num_positions", 0);
  p->num_velocities = size_in(from, "num_velocities", p->num_positions);
  p->num_constraints = size_in(from, "num_constraints", 0);
  p->num_nonholonomic = size_in(from, "num_nonholonomic", 0);
  if (is_multibody) {
    p->num_unknowns = p->num_positions + p->num_velocities + p->num_constraints + p->num_nonholonomic;
    p->num_equations = p->num_unknowns;
  } else {
    p->num_unknowns = size_in(from, "num_unknowns", 0);
    p->num_equations = size_in(from, "num_equations", p->num_unknowns);
    p->num_prescribed = (int)length_of(from, "prescribed");
    p->prescribed_values = handle_in(from, "prescribed_values");
    if (p->num_prescribed > 0 && p->prescribed_values == NULL) refuse("prescribed needs prescribed_values");
  }
  if (is_recorded) {
    const int of_time_alone = strcmp(form, "linear_equations") == 0;
    p->formulas = read_tape(field_of(from, "formulas"),
                            of_time_alone  ? 0
                            : is_multibody ? p->num_positions
                                           : p->num_unknowns,
                            of_time_alone  ? 0
                            : is_multibody ? p->num_velocities
                                           : p->num_unknowns);
  }
  if (is_multibody) read_multibody(p, from, is_recorded);
  else if (strncmp(form, "linear", 6) == 0) read_linear(p, from, is_recorded);
  else if (strcmp(form, "equations") == 0 || strcmp(form, "residual") == 0) read_nonlinear(p, from, is_recorded);
  else refuse("unknown form of problem: %s", form);
  if (p->kind == NONLINEAR) finish_nonlinear(p, from);
  return p;
}

int create_solver(const problem* p, const sfdae_options* options, sfdae_solver** solver) {
  if (p->kind == LINEAR) return sfdae_create_linear(solver, &p->as.linear, options);
  if (p->kind == NONLINEAR) return sfdae_create_nonlinear(solver, &p->as.nonlinear, options);
  return sfdae_create_multibody(solver, &p->as.multibody, options);
}
