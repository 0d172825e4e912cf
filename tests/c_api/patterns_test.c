/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Sparsity patterns of linear and nonlinear callbacks: forms of matrices, mistakes, what is copied.
 */
#include <math.h>
#include <string.h>

#include "checks.h"
#include "sfdae/sfdae.h"

/* x0' = x1, 0 = x1 + (1 + t) x0 - sin t: one entry of E, three of A, both compressed or dense. */
typedef struct {
  int compressed, extra;
} linear_user;

static int E(double t, int order, double* e, void* user) {
  (void)t, (void)user;
  if (order == 0) e[0] = 1;
  return 0;
}
/* By columns: (1, 0), (0, 1), (1, 1); dense: places 1, 2, 3. */
static int A(double t, int order, double* a, void* user) {
  const linear_user* u = (const linear_user*)user;
  const int shift = u->compressed ? 0 : 1;
  a[shift] = order == 0 ? -(1 + t) : order == 1 ? -1 : 0;
  if (order == 0) a[1 + shift] = 1, a[2 + shift] = -1;
  if (u->extra && t > 0.5) a[0] = 1e-300;
  return 0;
}
static int f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[1] = sin(t + order * acos(0.0));
  return 0;
}

static int E_start[] = {0, 1, 1}, E_rows[] = {0}, A_start[] = {0, 1, 3}, A_rows[] = {1, 0, 1};

static sfdae_linear_problem linear_problem(linear_user* user) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.E = E, problem.A = A, problem.f = f;
  problem.user = user;
  problem.E_entries = 1, problem.E_col_start = E_start, problem.E_row_index = E_rows;
  problem.A_entries = 3, problem.A_col_start = A_start, problem.A_row_index = A_rows;
  problem.matrices = user->compressed ? SFDAE_MATRICES_COMPRESSED : SFDAE_MATRICES_DENSE;
  return problem;
}

static double run(linear_user* user, int structure, int expected) {
  const sfdae_linear_problem problem = linear_problem(user);
  sfdae_solver* solver = NULL;
  sfdae_options options;
  double t = 0, x[2] = {1, -1}, xdot[2];
  int status;
  sfdae_options_init(&options, sizeof options);
  options.structure = structure;
  options.rtol = options.atol = 1e-9;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  status = sfdae_start(solver, 0, 1, x, xdot);
  if (status >= 0) status = sfdae_advance(solver, 1, &t, x, xdot);
  CHECK_STATUS(status, expected);
  if (expected == SFDAE_WRONG_PATTERN)
    CHECK(strstr(sfdae_message(solver), "A has the entry 1e-300 in row 0, column 0"));
  sfdae_destroy(&solver);
  return x[0];
}

static void linear_problems_are_the_same_in_all_forms(void) {
  linear_user dense = {0, 0}, compressed = {1, 0}, extra = {0, 1};
  const double reference = run(&dense, SFDAE_STRUCTURE_OFF, SFDAE_OK);
  CHECK(fabs(run(&dense, SFDAE_STRUCTURE_REQUIRED, SFDAE_OK) - reference) < 1e-7);
  CHECK(fabs(run(&compressed, SFDAE_STRUCTURE_OFF, SFDAE_OK) - reference) < 1e-7);
  CHECK(fabs(run(&compressed, SFDAE_STRUCTURE_REQUIRED, SFDAE_OK) - reference) < 1e-7);
  run(&extra, SFDAE_STRUCTURE_REQUIRED, SFDAE_WRONG_PATTERN);
  run(&extra, SFDAE_STRUCTURE_OFF, SFDAE_WRONG_PATTERN);
}

static void check_complaint(const sfdae_linear_problem* problem, const char* part) {
  char text[300];
  CHECK_STATUS(sfdae_check_linear(problem, NULL, text, sizeof text), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(text, part) != NULL);
}

static void mistakes_are_named(void) {
  linear_user user = {1, 0};
  sfdae_linear_problem problem = linear_problem(&user);
  problem.E_entries = 0, problem.E_col_start = problem.E_row_index = NULL;
  check_complaint(&problem, "patterns have to be given");
  problem.matrices = SFDAE_MATRICES_DENSE;
  check_complaint(&problem, "the pattern of E is missing");
  problem = linear_problem(&user);
  problem.A_row_index = NULL;
  check_complaint(&problem, "the pattern of A has col_start, but no row_index");
  problem = linear_problem(&user);
  problem.A_entries = 2;
  check_complaint(&problem, "col_start[2] is 3");
  problem = linear_problem(&user);
  problem.matrices = SFDAE_MATRICES_DIFFERENCES;
  check_complaint(&problem, "matrices is 2");
}

/* x0' = -x1, 0 = x1^3 + x1 - x0: F_x has (1, 0), (0, 1), (1, 1). */
static int F(double t, int order, const double* d, double* values, double* F_x, double* F_xdot, void* user) {
  (void)t, (void)user;
  if (order > 0 || F_x != NULL || F_xdot != NULL) return SFDAE_ORDER_NOT_AVAILABLE;
  values[0] = d[2] + d[1];
  values[1] = d[1] * d[1] * d[1] + d[1] - d[0];
  return 0;
}

static int formulas(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    sfdae_expression* to, void* user) {
  (void)record, (void)t, (void)user;
  to[0] = sfdae_add(xdot[0], x[0]);
  to[1] = x[1];
  return 0;
}

static sfdae_nonlinear_problem nonlinear_problem(void) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.total_derivative = F;
  problem.F_xdot_entries = 1, problem.F_xdot_col_start = E_start, problem.F_xdot_row_index = E_rows;
  problem.F_x_entries = 3, problem.F_x_col_start = A_start, problem.F_x_row_index = A_rows;
  problem.matrices = SFDAE_MATRICES_DIFFERENCES;
  return problem;
}

/* With x1 = v: v' = -v / (1 + 3 v^2), so that log v + 3/2 v^2 + t stays. */
static void differences_need_F_alone(void) {
  sfdae_nonlinear_problem problem = nonlinear_problem();
  sfdae_solver* solver = NULL;
  sfdae_options options;
  double t = 0, x[2] = {2, 1}, xdot[2];
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = 1e-8;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_OK);
  CHECK(fabs(xdot[0] + 1) < 1e-9 && fabs(xdot[1] + 0.25) < 1e-6);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, xdot), SFDAE_OK);
  CHECK(fabs(log(x[1]) + 1.5 * x[1] * x[1] + 1 - 1.5) < 1e-6);
  options.structure = SFDAE_STRUCTURE_OFF;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  x[0] = 2, x[1] = 1;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, xdot), SFDAE_OK);
  CHECK(fabs(log(x[1]) + 1.5 * x[1] * x[1] + 1 - 1.5) < 1e-6);
  sfdae_destroy(&solver);
}

static void differences_need_a_function(void) {
  sfdae_nonlinear_problem problem = nonlinear_problem();
  char text[300];
  problem.F_x_col_start = problem.F_xdot_col_start = NULL;
  problem.F_x_row_index = problem.F_xdot_row_index = NULL;
  problem.F_x_entries = problem.F_xdot_entries = 0;
  CHECK_STATUS(sfdae_check_nonlinear(&problem, NULL, text, sizeof text), SFDAE_OK);
  problem.total_derivative = NULL;
  problem.equations = formulas;
  CHECK_STATUS(sfdae_check_nonlinear(&problem, NULL, text, sizeof text), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(text, "derivatives of formulas are known") != NULL);
}

int main(void) {
  linear_problems_are_the_same_in_all_forms();
  mistakes_are_named();
  differences_need_F_alone();
  differences_need_a_function();
  return failures != 0;
}
