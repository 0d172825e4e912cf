/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Sensitivities through the C API: x1' = p x2, x2' = -p x1, 0 = z^3 + z - c x1, from (1, 0), and what is refused.
 */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

enum { N = 3, COUNT = 2 };
static const double p = 1.5, unset = -12345.678;

static int oscillator(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                      const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression rate = sfdae_parameter(record, "p", p), c = sfdae_parameter(record, "c", 2);
  (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], sfdae_multiply(rate, x[1]));
  F[1] = sfdae_add(xdot[1], sfdae_multiply(rate, x[0]));
  F[2] = sfdae_subtract(sfdae_add(sfdae_power(x[2], sfdae_number(3)), x[2]), sfdae_multiply(c, x[0]));
  return 0;
}

/* x_i' = k (x_{i-1} - x_i), x_0 = 1, and y_i = x_i^2 for i = 1 ... 100: solved by its structure alone. */
static int chain(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                 sfdae_expression* F, void* user) {
  const sfdae_expression k = sfdae_parameter(record, "k", 2);
  int i;
  (void)t, (void)user;
  for (i = 0; i < 100; i++) {
    const sfdae_expression before = i > 0 ? x[i - 1] : sfdae_number(1);
    F[i] = sfdae_subtract(xdot[i], sfdae_multiply(k, sfdae_subtract(before, x[i])));
    F[100 + i] = sfdae_subtract(x[100 + i], sfdae_multiply(x[i], x[i]));
  }
  return 0;
}

static int total_derivative(double t, int order, const double* jet, double* F, double* F_x, double* F_xdot,
                            void* user) {
  (void)t, (void)order, (void)jet, (void)F, (void)F_x, (void)F_xdot, (void)user;
  return 0;
}

static int mechanics(sfdae_record* record, sfdae_expression t, const sfdae_expression* q, const sfdae_expression* v,
                     const sfdae_multibody_formulas* formulas, void* user) {
  (void)t, (void)v, (void)user;
  formulas->M[0] = sfdae_number(1);
  formulas->f[0] = sfdae_negate(sfdae_multiply(sfdae_parameter(record, "k", 4), q[0]));
  return 0;
}

static int input(double t, int order, double* values, void* user) {
  (void)user;
  values[0] = order == 0 ? t : order == 1 ? 1 : 0;
  return 0;
}

/* x1' = x2 x1, where x2 is free or prescribed. */
static int free_component(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                          const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], sfdae_multiply(sfdae_parameter(record, "k", 1), sfdae_multiply(x[0], x[1])));
  return 0;
}

static sfdae_solver* solver_of(sfdae_equations_function function, int m, int n, const sfdae_options* options) {
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = m;
  problem.num_unknowns = n;
  problem.equations = function;
  if (function == NULL) problem.total_derivative = total_derivative;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, options), SFDAE_OK);
  return solver;
}

static sfdae_options options_with(double tolerance, int method) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tolerance;
  options.method = method;
  return options;
}

static const char* const names[COUNT] = {"p", NULL};
static const double directions[N * COUNT] = {0, 0, 0, 1, 0, 0};

static void report_says(const sfdae_solver* solver, const char* words) {
  static char text[20000];
  CHECK_STATUS(sfdae_report(solver, text, sizeof text, NULL), SFDAE_OK);
  CHECK(strstr(text, words) != NULL);
}

static void values_are_those_of_the_formulas(int method) {
  const sfdae_options options = options_with(1e-9, method);
  sfdae_solver* solver = solver_of(oscillator, N, N, &options);
  sfdae_sensitivity_statistics statistics;
  double x[N] = {1, 0, 0}, S[N * COUNT], Sdot[N * COUNT], t, slope;
  int k;
  CHECK_STATUS(sfdae_set_sensitivities(solver, COUNT, names, directions, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 3, x, NULL), SFDAE_OK);
  for (k = 0; k <= 6; k++) {
    t = 0;
    if (k > 0) CHECK_STATUS(sfdae_advance(solver, 0.5 * k, &t, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_get_sensitivities(solver, t, S, Sdot), SFDAE_OK);
    slope = 2 / (3 * x[2] * x[2] + 1);
    CHECK(fabs(S[0] + t * sin(p * t)) < 1e-6);
    CHECK(fabs(S[2] - slope * S[0]) < 1e-14 * (1 + t));
    CHECK(fabs(S[3] - cos(p * t)) < 1e-6);
    CHECK(fabs(Sdot[3] - p * S[4]) < 1e-12);
    CHECK(fabs(Sdot[0] - x[1] - p * S[1]) < 1e-12 * (1 + t));
    CHECK_STATUS(sfdae_get_sensitivities(solver, t, S, NULL), SFDAE_OK);
  }
  CHECK_STATUS(sfdae_sensitivity_statistics_init(&statistics, sizeof statistics), SFDAE_OK);
  CHECK_STATUS(sfdae_get_sensitivity_statistics(solver, &statistics), SFDAE_OK);
  CHECK(statistics.count == COUNT && statistics.outputs == 14 && statistics.factorizations > 0);
  /* Steps and stages are sparse systems here: the array is left for points within steps. */
  CHECK(statistics.linearizations > 0 && statistics.linearizations < 2 * statistics.outputs + 10);
  CHECK(statistics.error_test_failures == 0);
  report_says(solver, "2 sensitivities: ");
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

/* Saved at 0.7 and restored by another solver, which has to ask for the same. */
static void checkpoints_go_on(int method) {
  const sfdae_options options = options_with(1e-7, method);
  sfdae_solver *solver = solver_of(oscillator, N, N, &options), *other = solver_of(oscillator, N, N, &options);
  const char* const swapped[COUNT] = {names[1], names[0]};
  double x[N] = {1, 0, 0}, y[N], S[N * COUNT], S_other[N * COUNT], t, *checkpoint;
  size_t length;
  int i;
  CHECK_STATUS(sfdae_set_sensitivities(solver, COUNT, names, directions, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 3, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 0.7, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, &length), SFDAE_OK);
  checkpoint = malloc(length * sizeof *checkpoint);
  CHECK_STATUS(sfdae_save_checkpoint(solver, checkpoint, length), SFDAE_OK);
  CHECK_STATUS(sfdae_restore_checkpoint(other, checkpoint, length), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(other), "sfdae_set_sensitivities") != NULL);
  CHECK_STATUS(sfdae_set_sensitivities(other, COUNT, swapped, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_restore_checkpoint(other, checkpoint, length), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_sensitivities(other, COUNT, names, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_restore_checkpoint(other, checkpoint, length), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(other, 3, &t, y, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_sensitivities(solver, 3, S, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_sensitivities(other, 3, S_other, NULL), SFDAE_OK);
  for (i = 0; i < N; i++) CHECK(x[i] == y[i]);
  for (i = 0; i < N * COUNT; i++) CHECK(S[i] == S_other[i]);
  report_says(other, "2 sensitivities: ");
  free(checkpoint);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&other), SFDAE_OK);
}

static void large_problems_use_the_whole_array(void) {
  const sfdae_options options = options_with(1e-8, SFDAE_METHOD_BDF);
  sfdae_solver* solver = solver_of(chain, 200, 200, &options);
  static double x[200], S[200];
  const char* const name = "k";
  double t = 0;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  memset(x, 0, sizeof x);
  CHECK_STATUS(sfdae_set_sensitivities(solver, 1, &name, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_sensitivities(solver, 1, S, NULL), SFDAE_OK);
  /* x_1 = 1 - exp(-k t) */
  CHECK(fabs(S[0] - exp(-2.0)) < 1e-6 && fabs(S[100] - 2 * x[0] * S[0]) < 1e-12);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

#define REFUSED(call) \
  (CHECK_STATUS(call, SFDAE_ILLEGAL_ARGUMENT), CHECK(solver == NULL || sfdae_message(solver)[0] != '\0'))

static void mistakes_are_named(void) {
  sfdae_options options = options_with(1e-6, SFDAE_METHOD_BDF);
  sfdae_solver* solver = solver_of(oscillator, N, N, &options);
  sfdae_sensitivity_options how;
  sfdae_sensitivity_statistics statistics;
  const char* const unknown = "q";
  const double scales[COUNT] = {1, -1}, g_x[N] = {1, 0, 0}, nothing[N] = {0, 0, 0};
  double wrong[N * COUNT] = {0}, x[N] = {1, 0, 0}, S[N * COUNT], dt[COUNT], checkpoint[1], t = unset;
  size_t length;
  S[0] = dt[0] = unset;
  wrong[3] = NAN;
  CHECK_STATUS(sfdae_sensitivity_options_init(NULL, sizeof how), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_sensitivity_options_init(&how, sizeof how), SFDAE_OK);
  CHECK(how.size == sizeof how && how.error_test == 0 && how.scales == NULL);
  REFUSED(sfdae_set_sensitivities(solver, -1, NULL, NULL, NULL));
  REFUSED(sfdae_set_sensitivities(solver, 1, &unknown, NULL, NULL));
  CHECK(strstr(sfdae_message(solver), "\"q\"") != NULL);
  REFUSED(sfdae_set_sensitivities(solver, COUNT, names, wrong, NULL));
  how.error_test = 2;
  REFUSED(sfdae_set_sensitivities(solver, COUNT, names, directions, &how));
  how.error_test = 1;
  how.scales = scales;
  REFUSED(sfdae_set_sensitivities(solver, COUNT, names, directions, &how));
  how.scales = NULL;
  how.size = 0;
  REFUSED(sfdae_set_sensitivities(solver, COUNT, names, directions, &how));
  CHECK_STATUS(sfdae_get_sensitivities(solver, 0, S, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_sensitivities(solver, 0, S, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_event_sensitivities(solver, 0, 0, g_x, NULL, dt), SFDAE_NOT_STARTED);

  CHECK_STATUS(sfdae_sensitivity_options_init(&how, sizeof how), SFDAE_OK);
  how.error_test = 1;
  CHECK_STATUS(sfdae_set_sensitivities(solver, COUNT, names, directions, &how), SFDAE_OK);
  options.method = SFDAE_METHOD_RADAU;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  REFUSED(sfdae_get_sensitivities(solver, 0, NULL, NULL));
  REFUSED(sfdae_get_sensitivities(solver, NAN, S, NULL));
  REFUSED(sfdae_get_sensitivities(solver, 0.5, S, NULL));
  REFUSED(sfdae_get_event_sensitivities(solver, 0, 0, NULL, NULL, dt));
  REFUSED(sfdae_get_event_sensitivities(solver, 0, NAN, g_x, NULL, dt));
  CHECK_STATUS(sfdae_get_event_sensitivities(solver, 0, 0, nothing, nothing, dt), SFDAE_SINGULAR);
  CHECK(S[0] == unset && dt[0] == unset);
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, &length), SFDAE_OK);
  CHECK(length > N * COUNT);
  REFUSED(sfdae_save_checkpoint(solver, checkpoint, 1));
  REFUSED(sfdae_restore_checkpoint(solver, checkpoint, 1));
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_sensitivity_statistics(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_sensitivity_statistics(NULL, &statistics), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_sensitivities(NULL, 0, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_sensitivities(solver, 0, NULL, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

static void every_method_tests_their_errors(void) {
  const int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC};
  for (int k = 0; k < 3; ++k) {
    sfdae_options options = options_with(1e-6, methods[k]);
    sfdae_solver* solver = solver_of(oscillator, N, N, &options);
    sfdae_sensitivity_options how;
    sfdae_sensitivity_statistics statistics;
    double x[N] = {1, 0, 0}, t;
    long steps[2];
    for (int test = 0; test < 2; ++test) {
      sfdae_statistics of_x;
      /* As if S were 1000 times as large. */
      const double scales[COUNT] = {1000, 1000};
      sfdae_sensitivity_options_init(&how, sizeof how);
      how.error_test = test;
      how.scales = scales;
      x[0] = 1, x[1] = x[2] = 0;
      CHECK_STATUS(sfdae_set_sensitivities(solver, COUNT, names, directions, &how), SFDAE_OK);
      CHECK_STATUS(sfdae_start(solver, 0, 5, x, NULL), SFDAE_OK);
      CHECK_STATUS(sfdae_advance(solver, 5, &t, x, NULL), SFDAE_OK);
      sfdae_statistics_init(&of_x, sizeof of_x);
      CHECK_STATUS(sfdae_get_statistics(solver, &of_x), SFDAE_OK);
      steps[test] = of_x.steps;
      sfdae_sensitivity_statistics_init(&statistics, sizeof statistics);
      CHECK_STATUS(sfdae_get_sensitivity_statistics(solver, &statistics), SFDAE_OK);
      CHECK(test == 1 || statistics.error_test_failures == 0);
    }
    CHECK(steps[1] > steps[0]);
    CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
  }
}

/* q'' = -k q from (1, 0): q = cos(t sqrt k), dq/dk = -t sin(t sqrt k) / (2 sqrt k). */
static void mechanical_systems_have_them(void) {
  sfdae_options options = options_with(1e-9, SFDAE_METHOD_BDF);
  sfdae_solver* solver = NULL;
  sfdae_multibody_problem multibody;
  const char* const name = "k";
  double x[2] = {1, 0}, t, S[2];
  sfdae_multibody_problem_init(&multibody, sizeof multibody);
  multibody.num_positions = 1;
  multibody.equations = mechanics;
  CHECK_STATUS(sfdae_create_multibody(&solver, &multibody, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_set_sensitivities(solver, 1, &name, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_sensitivities(solver, 1, S, NULL), SFDAE_OK);
  CHECK(fabs(x[0] - cos(2)) <= 1e-6);
  CHECK(fabs(S[0] + sin(2) / 4) <= 1e-6);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

static void problems_without_sensitivities_are_named(void) {
  sfdae_options options = options_with(1e-6, SFDAE_METHOD_BDF);
  sfdae_solver* solver = solver_of(NULL, 1, 1, NULL);
  sfdae_nonlinear_problem problem;
  const char* const name = "k";
  const int component = 1;
  double x[N] = {1, 0, 0};
  sfdae_sensitivity_options adjoint;
  REFUSED(sfdae_set_sensitivities(solver, 1, NULL, NULL, NULL));
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);

  solver = solver_of(free_component, 1, 2, &options);
  CHECK_STATUS(sfdae_set_sensitivities(solver, 1, &name, NULL, NULL), SFDAE_OK);
  REFUSED(sfdae_start(solver, 0, 1, x, NULL));
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);

  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = 1;
  problem.num_unknowns = 2;
  problem.equations = free_component;
  problem.num_prescribed = 1;
  problem.prescribed = &component;
  problem.prescribed_values = input;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_set_sensitivities(solver, 1, &name, NULL, NULL), SFDAE_OK);
  REFUSED(sfdae_start(solver, 0, 1, x, NULL));
  CHECK(strstr(sfdae_message(solver), "prescribed") != NULL);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);

  options.structure = SFDAE_STRUCTURE_REQUIRED;
  solver = solver_of(oscillator, N, N, &options);
  CHECK_STATUS(sfdae_set_sensitivities(solver, COUNT, names, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  sfdae_sensitivity_options_init(&adjoint, sizeof adjoint);
  adjoint.adjoint = 1;
  CHECK_STATUS(sfdae_set_sensitivities(solver, COUNT, names, NULL, &adjoint), SFDAE_OK);
  REFUSED(sfdae_start(solver, 0, 1, x, NULL));
  CHECK(strstr(sfdae_message(solver), "adjoint") != NULL);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

/* x1 is fixed, but p moves it. */
static int circle(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                  sfdae_expression* F, void* user) {
  (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[1], x[0]);
  F[1] = sfdae_subtract(sfdae_multiply(x[0], x[0]), sfdae_parameter(record, "r", 1));
  return 0;
}

static void fixed_values_that_cannot_follow_are_named(void) {
  sfdae_options options = options_with(1e-6, SFDAE_METHOD_BDF);
  const int fixed[2] = {1, 0};
  const char* const name = "r";
  double x[2] = {1, 0}, direction[2] = {0.5, 0}, S[2];
  sfdae_solver* solver;
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = fixed;
  solver = solver_of(circle, 2, 2, &options);
  CHECK_STATUS(sfdae_set_sensitivities(solver, 1, &name, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_FIXED_VALUES);
  CHECK_STATUS(sfdae_get_sensitivities(solver, 0, S, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_set_sensitivities(solver, 1, &name, direction, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_sensitivities(solver, 0, S, NULL), SFDAE_OK);
  CHECK(fabs(S[0] - 0.5) < 1e-14 && S[1] == 0);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

/* Functionals of x at 0.5, 1.25 and 2: x1 + 3 z, and z(2). x1 = cos p t, S of p and of a start value x1(0) as above.
 * 1.25 is within a step. */
static void gradients_are_those_of_the_formulas(int method, long max_kept_steps) {
  const sfdae_options options = options_with(1e-9, method);
  sfdae_solver* solver = solver_of(oscillator, N, N, &options);
  sfdae_sensitivity_options how;
  sfdae_sensitivity_statistics statistics;
  const double times[3] = {2, 0.5, 1.25}, weights[2 * 3 * N] = {1, 0, 3, 1, 0, 3, 1, 0, 3, 0, 0, 1, 0, 0, 0, 0, 0, 0};
  double x[N] = {1, 0, 0}, gradient[2 * COUNT], z[3], t, slope;
  int k;
  CHECK_STATUS(sfdae_sensitivity_options_init(&how, sizeof how), SFDAE_OK);
  CHECK(how.max_kept_steps == 0);
  how.adjoint = 1;
  how.max_kept_steps = max_kept_steps;
  CHECK_STATUS(sfdae_set_sensitivities(solver, COUNT, names, directions, &how), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 2, x, NULL), SFDAE_OK);
  for (k = 1; k >= 0; k--) {
    CHECK_STATUS(sfdae_advance(solver, times[k], &t, x, NULL), SFDAE_OK);
    z[k] = x[2];
  }
  /* z^3 + z = 2 x1, as above. */
  for (k = 0, z[2] = 0; k < 50; k++) z[2] -= (z[2] * z[2] * z[2] + z[2] - 2 * cos(p * 1.25)) / (3 * z[2] * z[2] + 1);
  CHECK_STATUS(sfdae_get_gradient(solver, 3, times, 2, weights, gradient), SFDAE_OK);
  for (k = 0, slope = 0; k < 3; k++) slope -= times[k] * sin(p * times[k]) * (1 + 6 / (3 * z[k] * z[k] + 1));
  CHECK(fabs(gradient[0] - slope) < 1e-5);
  for (k = 0, slope = 0; k < 3; k++) slope += cos(p * times[k]) * (1 + 6 / (3 * z[k] * z[k] + 1));
  CHECK(fabs(gradient[1] - slope) < 1e-5);
  CHECK(fabs(gradient[2] + 2 * sin(2 * p) * 2 / (3 * z[0] * z[0] + 1)) < 1e-5);
  CHECK(fabs(gradient[3] - cos(2 * p) * 2 / (3 * z[0] * z[0] + 1)) < 1e-5);
  CHECK_STATUS(sfdae_sensitivity_statistics_init(&statistics, sizeof statistics), SFDAE_OK);
  CHECK_STATUS(sfdae_get_sensitivity_statistics(solver, &statistics), SFDAE_OK);
  CHECK(statistics.count == COUNT && statistics.kept_steps > 10 && statistics.kept_bytes > 1000);
  CHECK(max_kept_steps > 0 || (statistics.checkpoints == 0 && statistics.repeated_steps == 0));
  report_says(solver, "adjoint of 2 parameters: ");
  if (statistics.checkpoints > 0) report_says(solver, "steps made again");
  /* Radau takes few steps, all of which may be kept. */
  CHECK(max_kept_steps == 0 || method == SFDAE_METHOD_RADAU ||
        (statistics.checkpoints > 1 && statistics.repeated_steps > 10));
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

static void mistakes_of_gradients_are_named(void) {
  const sfdae_options options = options_with(1e-6, SFDAE_METHOD_BDF);
  sfdae_solver* solver = solver_of(oscillator, N, N, &options);
  sfdae_sensitivity_options how;
  const double times[2] = {1, 1.25}, nothing[N] = {0};
  double weights[2 * N] = {0}, x[N] = {1, 0, 0}, gradient[COUNT], S[N * COUNT], t, checkpoint[1];
  gradient[0] = S[0] = unset;
  CHECK_STATUS(sfdae_sensitivity_options_init(&how, sizeof how), SFDAE_OK);
  CHECK(how.adjoint == 0);
  how.adjoint = 2;
  REFUSED(sfdae_set_sensitivities(solver, COUNT, names, directions, &how));
  how.adjoint = how.error_test = 1;
  REFUSED(sfdae_set_sensitivities(solver, COUNT, names, directions, &how));
  how.error_test = 0;
  how.max_kept_steps = -1;
  REFUSED(sfdae_set_sensitivities(solver, COUNT, names, directions, &how));
  how.max_kept_steps = 1;
  REFUSED(sfdae_set_sensitivities(solver, COUNT, names, directions, &how));
  how.max_kept_steps = 2;
  how.adjoint = 0;
  REFUSED(sfdae_set_sensitivities(solver, COUNT, names, directions, &how));
  how.adjoint = 1;
  CHECK_STATUS(sfdae_set_sensitivities(solver, COUNT, names, directions, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_gradient(solver, 1, times, 1, nothing, gradient), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_gradient(solver, 1, times, 1, nothing, gradient), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_set_sensitivities(solver, COUNT, names, directions, &how), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  REFUSED(sfdae_get_gradient(solver, 2, times, 1, weights, gradient)); /* no step has led to 1.25 */
  CHECK(strstr(sfdae_message(solver), "1.25") != NULL);
  REFUSED(sfdae_get_gradient(solver, 0, times, 1, weights, gradient));
  REFUSED(sfdae_get_gradient(solver, 1, times, 0, weights, gradient));
  REFUSED(sfdae_get_gradient(solver, 1, NULL, 1, weights, gradient));
  REFUSED(sfdae_get_gradient(solver, 1, times, 1, NULL, gradient));
  REFUSED(sfdae_get_gradient(solver, 1, times, 1, weights, NULL));
  weights[1] = NAN;
  REFUSED(sfdae_get_gradient(solver, 1, times, 1, weights, gradient));
  weights[1] = 1e308;
  weights[0] = 1e308;
  CHECK_STATUS(sfdae_get_sensitivities(solver, 1, S, NULL), SFDAE_NOT_STARTED);
  REFUSED(sfdae_save_checkpoint(solver, checkpoint, 1));
  CHECK(strstr(sfdae_message(solver), "adjoint") != NULL);
  REFUSED(sfdae_restore_checkpoint(solver, checkpoint, 1));
  CHECK(strstr(sfdae_message(solver), "adjoint") != NULL);
  CHECK(gradient[0] == unset && S[0] == unset);
  CHECK_STATUS(sfdae_get_gradient(NULL, 1, times, 1, nothing, gradient), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_gradient(solver, 1, times, 1, nothing, gradient), SFDAE_OK);
  CHECK(gradient[0] == 0 && gradient[1] == 0);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

int main(void) {
  gradients_are_those_of_the_formulas(SFDAE_METHOD_BDF, 0);
  gradients_are_those_of_the_formulas(SFDAE_METHOD_BDF, 60);
  gradients_are_those_of_the_formulas(SFDAE_METHOD_RADAU, 0);
  gradients_are_those_of_the_formulas(SFDAE_METHOD_RADAU, 60);
  mistakes_of_gradients_are_named();
  values_are_those_of_the_formulas(SFDAE_METHOD_BDF);
  values_are_those_of_the_formulas(SFDAE_METHOD_RADAU);
  values_are_those_of_the_formulas(SFDAE_METHOD_AUTOMATIC);
  checkpoints_go_on(SFDAE_METHOD_BDF);
  checkpoints_go_on(SFDAE_METHOD_RADAU);
  large_problems_use_the_whole_array();
  mistakes_are_named();
  every_method_tests_their_errors();
  mechanical_systems_have_them();
  problems_without_sensitivities_are_named();
  fixed_values_that_cannot_follow_are_named();
  return failures > 0;
}
