/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Conditions that callbacks declare, in C: a divider of two capacitors whose source steps where a clock unknown passes
 * 1, as a linear problem (E, A, f) and as a nonlinear one. Its exact solution has vm(2) = exp(-1/2) / 2. */
#include <math.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

/* x: vs, vm, i, clock. i = vs' - vm' = vm' + vm, vs = 1 if clock > 1, else 0, clock' = 1. */
enum { n = 4 };
static int branches[1];

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order > 0) return 0;
  matrix[0 + n * 0] = -1, matrix[0 + n * 1] = 1;
  matrix[1 + n * 0] = 1, matrix[1 + n * 1] = -2;
  matrix[3 + n * 3] = 1;
  return 0;
}
static int A(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order > 0) return 0;
  matrix[0 + n * 2] = -1;
  matrix[1 + n * 1] = 1;
  matrix[2 + n * 0] = -1;
  return 0;
}
static int f(double t, int order, double* vector, void* user) {
  (void)t, (void)user;
  if (order > 0) return 0;
  vector[2] = branches[0];
  vector[3] = 1;
  return 0;
}
static int conditions(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = x[3] - 1;
  return 0;
}

static int residual(double t, int order, const double* x, double* F, double* F_x, double* F_xdot, void* user) {
  double of_E[n * n] = {0}, of_A[n * n] = {0}, of_f[n] = {0};
  E(t, 0, of_E, user), A(t, 0, of_A, user), f(t, order, of_f, user);
  for (int i = 0; i < n; ++i) F[i] = -of_f[i];
  for (int k = 0; k < n * n; ++k) {
    F[k % n] += of_E[k] * x[n * (order + 1) + k / n] - of_A[k] * x[n * order + k / n];
    if (F_x != NULL && order == 0) F_x[k] = -of_A[k], F_xdot[k] = of_E[k];
  }
  return 0;
}

static void run(sfdae_solver* solver) {
  double t, x[n] = {0}, xdot[n];
  long count;
  char text[80];
  sfdae_switch passed;
  CHECK_STATUS(sfdae_start(solver, 0, 2, x, xdot), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
  CHECK(fabs(x[1] - 0.5 * exp(-0.5)) < 1e-5);
  CHECK_STATUS(sfdae_get_num_switches(solver, &count), SFDAE_OK);
  CHECK(count == 1);
  sfdae_switch_init(&passed, sizeof passed);
  CHECK_STATUS(sfdae_get_switch(solver, 0, &passed, text, sizeof text, NULL), SFDAE_OK);
  CHECK(fabs(passed.t - 1) < 1e-6 && passed.jumps == 1 && passed.before == 0 && passed.after == 1);
  CHECK(strcmp(text, "condition 0 of the callbacks") == 0);
  sfdae_destroy(&solver);
}

int main(void) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  CHECK(options.conditions == SFDAE_CONDITIONS_EVENTS);
  for (int method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_RADAU; ++method) {
    sfdae_solver* solver = NULL;
    options.method = method;

    sfdae_linear_problem linear;
    sfdae_linear_problem_init(&linear, sizeof linear);
    linear.num_equations = linear.num_unknowns = n;
    linear.E = E, linear.A = A, linear.f = f;
    linear.constant_E = linear.constant_A = 1;
    linear.num_conditions = 1, linear.conditions = conditions, linear.branches = branches;
    CHECK_STATUS(sfdae_create_linear(&solver, &linear, &options), SFDAE_OK);
    run(solver);

    sfdae_nonlinear_problem nonlinear;
    sfdae_nonlinear_problem_init(&nonlinear, sizeof nonlinear);
    nonlinear.num_equations = nonlinear.num_unknowns = n;
    nonlinear.total_derivative = residual;
    nonlinear.num_conditions = 1, nonlinear.conditions = conditions, nonlinear.branches = branches;
    CHECK_STATUS(sfdae_create_nonlinear(&solver, &nonlinear, &options), SFDAE_OK);
    run(solver);

    linear.branches = NULL;
    CHECK_STATUS(sfdae_create_linear(&solver, &linear, &options), SFDAE_ILLEGAL_ARGUMENT);
    linear.branches = branches, linear.matrices = SFDAE_MATRICES_COMPRESSED;
    CHECK_STATUS(sfdae_create_linear(&solver, &linear, &options), SFDAE_ILLEGAL_ARGUMENT);
    nonlinear.num_conditions = -1;
    CHECK_STATUS(sfdae_create_nonlinear(&solver, &nonlinear, &options), SFDAE_ILLEGAL_ARGUMENT);
  }
  options.conditions = 2;
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = n;
  problem.total_derivative = residual;
  sfdae_solver* solver = NULL;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(NULL), "SFDAE_CONDITIONS_") != NULL);
  return failures > 0;
}
