/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Names that users give to their equations: in every message that speaks of one, for every kind of problem, copied.
 */
#include <math.h>
#include <string.h>

#include "checks.h"

static int contains(const char* text, const char* part) {
  if (strstr(text, part)) return 1;
  fprintf(stderr, "\"%s\" is not in \"%s\"\n", part, text);
  return 0;
}

/* ---- Linear problems ----------------------------------------------------------------------------------------- */

/* x1' = x2, 0 = x1 - sin t, 0 = 2 x1 - 2 sin t - offset: the last two contradict each other. */
typedef struct {
  double offset;
  int mistake; /* 1: a wrong derivative of f, in row 1; 2: NaN in row 1 of A; 3: in row 2 of f */
} linear_user;

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = 1;
  return 0;
}
static int A(double t, int order, double* matrix, void* user) {
  (void)t;
  if (order == 0) matrix[1] = 1, matrix[2] = 2, matrix[3] = 1;
  if (((linear_user*)user)->mistake == 2) matrix[4] = sqrt(-1.0 - t * t);
  return 0;
}
static int f(double t, int order, double* vector, void* user) {
  const linear_user* u = (const linear_user*)user;
  const double wave = sin(t + order * acos(0.0));
  vector[1] = -wave, vector[2] = -2 * wave - (order == 0 ? u->offset : 0);
  if (u->mistake == 1 && order == 1) vector[1] = -vector[1];
  if (u->mistake == 3) vector[2] = sqrt(-1.0 - t * t);
  return 0;
}

/* The solver, created with names that are gone afterwards. */
static sfdae_solver* linear(linear_user* user) {
  char first[20] = "definition of speed", second[20] = "path";
  const char* names[3];
  sfdae_solver* solver = NULL;
  sfdae_linear_problem problem;
  names[0] = first, names[1] = second, names[2] = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  CHECK(problem.equation_names == NULL);
  problem.num_equations = 3, problem.num_unknowns = 2;
  problem.E = E, problem.A = A, problem.f = f;
  problem.user = user;
  problem.equation_names = names;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  memset(first, 'z', sizeof first - 1);
  memset(second, 'z', sizeof second - 1);
  return solver;
}

static void linear_messages_have_names(void) {
  linear_user user = {0.25, 0};
  double x[2] = {0, 1}, t = 0;
  char report[4000];
  sfdae_derivative_check check;
  sfdae_solver* solver = linear(&user);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_INCONSISTENT_EQUATIONS);
  CHECK(contains(sfdae_message(solver), "It is equations 1 (path) and 2 that cannot hold together."));
  CHECK_STATUS(sfdae_report(solver, report, sizeof report, NULL), SFDAE_OK);
  CHECK(contains(report, "equations 1 (path) and 2 that"));

  sfdae_destroy(&solver);

  user.offset = 0, user.mistake = 1;
  solver = linear(&user);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_WRONG_DERIVATIVES);
  CHECK(contains(sfdae_message(solver), "derivative 1 of f contradicts differences in equation 1 (path), column 0"));
  sfdae_derivative_check_init(&check, sizeof check);
  CHECK_STATUS(sfdae_check_derivatives(solver, 0.5, 1, &check), SFDAE_OK);
  CHECK(check.suspicious == 1 && check.row == 1);
  CHECK(contains(sfdae_message(solver), "derivative 1 of f differs from differences in equation 1 (path), column 0"));

  user.mistake = 2;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_NOT_FINITE);
  CHECK(contains(sfdae_message(solver), "A returned NaN") &&
        contains(sfdae_message(solver), "in equation 1 (path), column 1 of derivative order 0"));
  user.mistake = 3; /* an equation without a name */
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_NOT_FINITE);
  CHECK(contains(sfdae_message(solver), "f returned NaN") && contains(sfdae_message(solver), "in row 2, column 0"));

  user.mistake = 0;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(fabs(x[0] - sin(1.0)) < 1e-5);
  sfdae_destroy(&solver);
}

/* ---- Recorded equations -------------------------------------------------------------------------------------- */

typedef struct {
  int which;
} recorded_user;

/* 0: x0' = -x0, x1 = log(x0 - 1/2). 1: x0 x0 = -1, x1 = 0. 2: the second one is not set. 3: x0 = t, x0' = 2, linear. */
static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const int which = ((const recorded_user*)user)->which;
  (void)record;
  F[0] = which == 1   ? sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_number(1))
         : which == 3 ? sfdae_subtract(x[0], t)
                      : sfdae_add(xdot[0], x[0]);
  if (which == 0) F[1] = sfdae_subtract(x[1], sfdae_log(sfdae_subtract(x[0], sfdae_number(0.5))));
  if (which == 1) F[1] = x[1];
  if (which == 3) F[1] = sfdae_subtract(xdot[0], sfdae_number(2));
  return 0;
}

static const char* const two_names[] = {"balance of mass", "level"};

static sfdae_nonlinear_problem recorded(recorded_user* user) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  CHECK(problem.equation_names == NULL);
  problem.num_equations = problem.num_unknowns = 2;
  problem.equations = equations;
  problem.user = user;
  problem.equation_names = two_names;
  return problem;
}

static void recorded_messages_have_names(void) {
  recorded_user user = {0};
  double x[2] = {0.25, 0};
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem problem = recorded(&user);
  char text[500];
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_NOT_FINITE);
  CHECK(contains(sfdae_message(solver), "log of -0.25 in equation 1 (level)"));
  sfdae_destroy(&solver);

  user.which = 1;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  CHECK(sfdae_start(solver, 0, 1, x, NULL) < 0);
  CHECK(contains(sfdae_message(solver), "equation 0 (balance of mass)"));
  sfdae_destroy(&solver);

  user.which = 2;
  CHECK_STATUS(sfdae_check_nonlinear(&problem, NULL, text, sizeof text), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(contains(text, "residual[1] (level) was not set"));

  user.which = 3; /* solved as a linear problem */
  problem.num_unknowns = 1;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_INCONSISTENT_EQUATIONS);
  CHECK(contains(sfdae_message(solver),
                 "equations 0 (balance of mass, differentiated once) and 1 (level) that cannot hold together."));
  sfdae_destroy(&solver);
}

/* E = sqrt(t - 1), in the second equation. */
static int linear_equations(sfdae_record* record, sfdae_expression t, sfdae_expression* E_, sfdae_expression* A_,
                            sfdae_expression* f_, void* user) {
  (void)record, (void)f_, (void)user;
  E_[0] = sfdae_number(1);
  E_[3] = sfdae_sqrt(sfdae_subtract(t, sfdae_number(1)));
  A_[0] = A_[3] = sfdae_number(1);
  return 0;
}

static void recorded_linear_messages_have_names(void) {
  double x[2] = {1, 1};
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem problem = recorded(NULL);
  problem.equations = NULL;
  problem.linear_equations = linear_equations;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 0.5, x, NULL), SFDAE_NOT_FINITE);
  CHECK(contains(sfdae_message(solver), "sqrt of -1 in equation 1 (level)"));
  sfdae_destroy(&solver);
}

/* Instances of an ensemble are solved by copies of the problem. */
static void instances_have_names(void) {
  recorded_user user = {0};
  const double x0[4] = {2, log(1.5), 0.25, 0}, times[1] = {0.1};
  double x[4];
  int statuses[2], outputs[2];
  char messages[2][400];
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem problem = recorded(&user);
  sfdae_ensemble ensemble;
  sfdae_ensemble_results results;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  sfdae_ensemble_init(&ensemble, sizeof ensemble);
  sfdae_ensemble_results_init(&results, sizeof results);
  ensemble.num_instances = 2, ensemble.x0 = x0, ensemble.num_times = 1, ensemble.times = times;
  ensemble.num_threads = 2;
  results.x = x, results.statuses = statuses, results.num_outputs = outputs;
  results.messages = &messages[0][0], results.message_length = sizeof messages[0];
  CHECK_STATUS(sfdae_solve_ensemble(solver, &ensemble, &results), SFDAE_INSTANCES_FAILED);
  CHECK(statuses[0] == SFDAE_OK && statuses[1] == SFDAE_NOT_FINITE);
  CHECK(contains(messages[1], "log of -0.25 in equation 1 (level)"));
  sfdae_destroy(&solver);
}

/* ---- Callbacks for total derivatives ------------------------------------------------------------------------- */

/* F = (x0' + x0, x1 - x0^2) with one mistake: 1: F_x of the second equation; 2: NaN there. */
static int total(double t, int order, const double* d, double* F, double* F_x, double* F_xdot, void* user) {
  const int mistake = *(const int*)user;
  const double *x = d + 2 * order, *xdot = d + 2 * (order + 1);
  if (order > 1) return SFDAE_ORDER_NOT_AVAILABLE;
  F[0] = xdot[0] + x[0];
  F[1] = x[1] - (order == 0 ? d[0] * d[0] : 2 * d[0] * d[2]);
  if (mistake == 2) F[1] = sqrt(-1 - t * t);
  if (!F_x) return 0;
  if (order == 0) F_x[0] = 1, F_xdot[0] = 1, F_x[3] = 1;
  F_x[1] = -2 * x[0] * (mistake == 1 ? 2 : 1);
  return 0;
}

static void callback_messages_have_names(void) {
  int mistake = 1;
  double x[2] = {1, 1};
  const double derivatives[6] = {1, 1, -1, -2, 1, 4};
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem problem = recorded(NULL);
  sfdae_derivative_check check;
  problem.equations = NULL;
  problem.total_derivative = total;
  problem.user = &mistake;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_WRONG_DERIVATIVES);
  CHECK(
      contains(sfdae_message(solver), "derivative 0 of F_x contradicts differences in equation 1 (level), column 0"));
  sfdae_derivative_check_init(&check, sizeof check);
  CHECK_STATUS(sfdae_check_total_derivatives(solver, 0, derivatives, 1, &check), SFDAE_OK);
  CHECK(contains(sfdae_message(solver), "in equation 1 (level), column 0"));
  mistake = 2;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_NOT_FINITE);
  CHECK(contains(sfdae_message(solver), "F returned NaN") &&
        contains(sfdae_message(solver), "in equation 1 (level), column 0 of derivative order 0"));
  sfdae_destroy(&solver);
}

/* Callers that were compiled when the structs ended before the names. */
static void older_structs_have_none(void) {
  recorded_user user = {2};
  char text[500];
  sfdae_nonlinear_problem problem = recorded(&user);
  problem.size = (size_t)((char*)&problem.equation_names - (char*)&problem);
  CHECK_STATUS(sfdae_check_nonlinear(&problem, NULL, text, sizeof text), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(contains(text, "residual[1] was not set"));
}

int main(void) {
  linear_messages_have_names();
  recorded_messages_have_names();
  recorded_linear_messages_have_names();
  instances_have_names();
  callback_messages_have_names();
  older_structs_have_none();
  return failures != 0;
}
