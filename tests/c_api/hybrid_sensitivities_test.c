/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Sensitivities of hybrid systems through the C API: x' = k to x = 1, x' = -k x after that, and what is refused in
 * which order.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include <sfdae/hybrid.h>

#include "checks.h"

enum { N = 1 };

static int rising(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                  sfdae_expression* F, void* user) {
  (void)t, (void)x, (void)user;
  F[0] = sfdae_subtract(xdot[0], sfdae_parameter(record, "k", 2));
  return 0;
}

static int decaying(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    sfdae_expression* F, void* user) {
  (void)t, (void)user;
  F[0] = sfdae_add(xdot[0], sfdae_multiply(sfdae_parameter(record, "r", 3), x[0]));
  return 0;
}

static int total_derivative(double t, int order, const double* jet, double* F, double* F_x, double* F_xdot,
                            void* user) {
  (void)t, (void)order, (void)user;
  F[0] = jet[1];
  F_x[0] = 0;
  F_xdot[0] = 1;
  return 0;
}

static int level(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = x[0] - 1;
  return 0;
}

static int surface(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                   sfdae_expression* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = sfdae_subtract(x[0], sfdae_parameter(record, "h", 1));
  return 0;
}

static sfdae_solver* solver_of(sfdae_equations_function equations) {
  sfdae_nonlinear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = 1e-9;
  problem.num_equations = problem.num_unknowns = N;
  problem.equations = equations;
  if (equations == NULL) problem.total_derivative = total_derivative;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  return solver;
}

static void add_level(sfdae_hybrid* hybrid) {
  sfdae_transition transition;
  sfdae_transition_init(&transition, sizeof transition);
  transition.to = 1;
  transition.kind = SFDAE_TRANSITION_ZERO;
  transition.function = level;
  CHECK_STATUS(sfdae_add_transition(hybrid, &transition, NULL), SFDAE_OK);
}

#define REFUSED(call) (CHECK_STATUS(call, SFDAE_ILLEGAL_ARGUMENT), CHECK(sfdae_get_hybrid_message(hybrid)[0] != '\0'))

/* x = k t to t = 1 / k, exp(-r (t - 1 / k)) after that. */
static void values_are_those_of_the_formulas(void) {
  sfdae_solver *first = solver_of(rising), *second = solver_of(decaying);
  sfdae_hybrid* hybrid;
  const char* const names[] = {"k", "r", NULL};
  const double directions[] = {0, 0, 1};
  double x = 0, xdot, t = 0, S[3] = {0}, Sdot[3], dt[3];
  int mode;
  char text[4096];
  CHECK_STATUS(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(hybrid, first, "rises", NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(hybrid, second, "decays", NULL), SFDAE_OK);
  add_level(hybrid);
  CHECK_STATUS(sfdae_get_hybrid_sensitivities(hybrid, 0, S, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_set_hybrid_sensitivities(hybrid, 3, names, directions, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_hybrid_sensitivities(hybrid, 0, S, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_passage_sensitivities(hybrid, dt), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 0.25, &t, &x, &xdot), SFDAE_OK);
  CHECK_STATUS(sfdae_get_hybrid_sensitivities(hybrid, 0.25, S, Sdot), SFDAE_OK);
  CHECK(fabs(S[0] - 0.25) < 1e-8 && fabs(S[1]) < 1e-12 && fabs(S[2] - 1) < 1e-8 && fabs(Sdot[0] - 1) < 1e-8);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 0.9, &t, &x, &xdot), SFDAE_OK);
  CHECK_STATUS(sfdae_get_current_mode(hybrid, &mode), SFDAE_OK);
  CHECK(mode == 1 && fabs(x - exp(-1.2)) < 1e-7);
  CHECK_STATUS(sfdae_get_hybrid_sensitivities(hybrid, 0.9, S, NULL), SFDAE_OK);
  CHECK(fabs(S[0] + 0.75 * x) < 1e-7); /* -r / k^2 x */
  CHECK(fabs(S[1] + 0.4 * x) < 1e-7);
  CHECK(fabs(S[2] + 1.5 * x) < 1e-7); /* dt = -1 / k, so r dt x */
  CHECK_STATUS(sfdae_get_passage_sensitivities(hybrid, dt), SFDAE_OK);
  CHECK(fabs(dt[0] + 0.25) < 1e-8 && dt[1] == 0 && fabs(dt[2] + 0.5) < 1e-8);
  CHECK_STATUS(sfdae_report_hybrid(hybrid, text, sizeof text, NULL), SFDAE_OK);
  CHECK(strstr(text, "3 sensitivities") != NULL);
  /* A run without them. */
  CHECK_STATUS(sfdae_set_hybrid_sensitivities(hybrid, 0, NULL, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 0.95, &t, &x, &xdot), SFDAE_NOT_STARTED);
  x = 0;
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 0.9, &t, &x, &xdot), SFDAE_OK);
  CHECK_STATUS(sfdae_get_hybrid_sensitivities(hybrid, 0.9, S, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
  /* The solvers are free again. */
  CHECK_STATUS(sfdae_set_sensitivities(first, 1, names, NULL, NULL), SFDAE_OK);
  x = 0;
  CHECK_STATUS(sfdae_start(first, 0, 1, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&first), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&second), SFDAE_OK);
}

/* x = k t to the surface x = h, along which both modes keep it. */
static void values_are_those_along_a_surface(void) {
  sfdae_solver *first = solver_of(rising), *second = solver_of(decaying);
  sfdae_hybrid* hybrid;
  const char* const names[] = {"h", "k", "r"};
  double x = 0, t = 0, S[3] = {5, 5, 5}, Sdot[3], dt[3];
  int mode, along;
  CHECK_STATUS(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(hybrid, first, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(hybrid, second, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_add_switch(hybrid, 0, 1, surface, NULL, "along", &along), SFDAE_OK);
  CHECK_STATUS(sfdae_set_hybrid_sensitivities(hybrid, 3, names, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 0.9, &t, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_current_mode(hybrid, &mode), SFDAE_OK);
  CHECK(mode == along && fabs(x - 1) < 1e-8);
  CHECK_STATUS(sfdae_get_hybrid_sensitivities(hybrid, 0.9, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_hybrid_sensitivities(hybrid, NAN, S, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(S[0] == 5 && S[1] == 5 && S[2] == 5);
  CHECK_STATUS(sfdae_get_hybrid_sensitivities(hybrid, 0.9, S, Sdot), SFDAE_OK);
  CHECK(fabs(S[0] - 1) < 1e-8 && fabs(S[1]) < 1e-8 && fabs(S[2]) < 1e-8 && fabs(Sdot[0]) < 1e-7);
  CHECK_STATUS(sfdae_get_passage_sensitivities(hybrid, dt), SFDAE_OK);
  CHECK(fabs(dt[0] - 0.5) < 1e-8 && fabs(dt[1] + 0.25) < 1e-8 && fabs(dt[2]) < 1e-8);
  CHECK_STATUS(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&first), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&second), SFDAE_OK);
}

/* The same by the adjoint: x at 0.25, at the transition, and at the end. */
static void gradients_are_those_of_the_formulas(void) {
  sfdae_solver *first = solver_of(rising), *second = solver_of(decaying);
  sfdae_hybrid* hybrid;
  sfdae_sensitivity_options how;
  sfdae_sensitivity_statistics work;
  const char* const names[] = {"k", "r", NULL};
  const double directions[] = {0, 0, 1}, nan = NAN;
  double x = 0, t = 0, times[] = {0.25, 0.5, 0.9}, weights[] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, gradient[9], S[3];
  double untouched = 7, early = -1, late = 0.95, beside = 0.3;
  size_t length;
  char text[4096];
  CHECK_STATUS(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(hybrid, first, "rises", NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(hybrid, second, "decays", NULL), SFDAE_OK);
  add_level(hybrid);
  sfdae_sensitivity_options_init(&how, sizeof how);
  how.adjoint = 1;
  CHECK_STATUS(sfdae_set_hybrid_sensitivities(hybrid, 3, names, directions, &how), SFDAE_OK);
  CHECK_STATUS(sfdae_get_hybrid_gradient(hybrid, 1, times, 1, weights, &untouched), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 0.25, &t, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_to_transition(hybrid, 0.9, &t, &x, NULL), SFDAE_EVENT);
  CHECK(fabs(t - 0.5) < 1e-8);
  times[1] = t;
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 0.9, &t, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_hybrid_gradient(hybrid, 3, times, 3, weights, gradient), SFDAE_OK);
  CHECK(fabs(gradient[0] - 0.25) < 1e-8 && fabs(gradient[1]) < 1e-12 && fabs(gradient[2] - 1) < 1e-8);
  /* x after the transition, at a time that does not move: (x'_before - x'_after) dt + S. */
  CHECK(fabs(gradient[3] + 0.75) < 1e-7 && fabs(gradient[4]) < 1e-7 && fabs(gradient[5] + 1.5) < 1e-7);
  CHECK(fabs(gradient[6] + 0.75 * x) < 1e-7 && fabs(gradient[7] + 0.4 * x) < 1e-7 &&
        fabs(gradient[8] + 1.5 * x) < 1e-7);
  CHECK_STATUS(sfdae_report_hybrid(hybrid, text, sizeof text, NULL), SFDAE_OK);
  CHECK(strstr(text, "adjoint of 3 parameters") != NULL);
  sfdae_sensitivity_statistics_init(&work, sizeof work);
  CHECK_STATUS(sfdae_get_sensitivity_statistics(second, &work), SFDAE_OK);
  CHECK(work.count == 3 && work.kept_steps > 0);

  CHECK_STATUS(sfdae_get_hybrid_gradient(NULL, 1, times, 1, weights, &untouched), SFDAE_ILLEGAL_ARGUMENT);
  REFUSED(sfdae_get_hybrid_gradient(hybrid, 1, NULL, 1, weights, &untouched));
  REFUSED(sfdae_get_hybrid_gradient(hybrid, 1, times, 1, NULL, &untouched));
  REFUSED(sfdae_get_hybrid_gradient(hybrid, 1, times, 1, weights, NULL));
  REFUSED(sfdae_get_hybrid_gradient(hybrid, 0, times, 1, weights, &untouched));
  REFUSED(sfdae_get_hybrid_gradient(hybrid, 1, times, 0, weights, &untouched));
  REFUSED(sfdae_get_hybrid_gradient(hybrid, 1, &nan, 1, weights, &untouched));
  REFUSED(sfdae_get_hybrid_gradient(hybrid, 1, times, 1, &nan, &untouched));
  REFUSED(sfdae_get_hybrid_gradient(hybrid, 1, &early, 1, weights, &untouched));
  REFUSED(sfdae_get_hybrid_gradient(hybrid, 1, &late, 1, weights, &untouched));
  CHECK(strstr(sfdae_get_hybrid_message(hybrid), "where steps have led") != NULL);
  /* Within a step of a mode that was left. */
  CHECK_STATUS(sfdae_get_hybrid_gradient(hybrid, 1, &beside, 1, weights, gradient), SFDAE_OK);
  CHECK(fabs(gradient[0] - 0.3) < 1e-8 && fabs(gradient[1]) < 1e-12 && fabs(gradient[2] - 1) < 1e-8);
  CHECK_STATUS(sfdae_get_gradient(second, 1, times, 1, weights, &untouched), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(second), "sfdae_get_hybrid_gradient") != NULL);
  CHECK_STATUS(sfdae_get_hybrid_sensitivities(hybrid, 0.9, S, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_passage_sensitivities(hybrid, S), SFDAE_NOT_STARTED);
  REFUSED(sfdae_get_hybrid_checkpoint_length(hybrid, &length));
  REFUSED(sfdae_restore_hybrid_checkpoint(hybrid, weights, 9));
  /* A value of its own for the mode that was left: its steps were others. */
  CHECK_STATUS(sfdae_set_parameter(first, "k", 3), SFDAE_OK);
  CHECK_STATUS(sfdae_get_hybrid_gradient(hybrid, 1, times + 1, 1, weights, &untouched), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_get_hybrid_message(hybrid), "other values") != NULL);
  CHECK(untouched == 7);
  CHECK_STATUS(sfdae_set_parameter(first, "k", 2), SFDAE_OK);
  CHECK_STATUS(sfdae_get_hybrid_gradient(hybrid, 3, times, 3, weights, gradient), SFDAE_OK);
  CHECK(fabs(gradient[6] + 0.75 * x) < 1e-7);
  CHECK_STATUS(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&first), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&second), SFDAE_OK);
}

/* x = k t to the surface x = h, along which it stays, whatever h is changed to: gradients at 0.25 and 0.9 by h and k.
 * */
static void gradients_go_back_along_a_surface(void) {
  sfdae_solver *first = solver_of(rising), *second = solver_of(decaying);
  sfdae_hybrid* hybrid;
  sfdae_sensitivity_options how;
  const char* const names[] = {"h", "k"};
  const double times[] = {0.25, 0.9}, weights[] = {1, 0, 0, 1};
  double x = 0, t = 0, gradient[4];
  int mode, along;
  CHECK_STATUS(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(hybrid, first, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(hybrid, second, NULL, NULL), SFDAE_OK);
  sfdae_sensitivity_options_init(&how, sizeof how);
  how.adjoint = 1;
  CHECK_STATUS(sfdae_add_switch(hybrid, 0, 1, surface, NULL, "along", &along), SFDAE_OK);
  CHECK_STATUS(sfdae_set_hybrid_sensitivities(hybrid, 2, names, NULL, &how), SFDAE_OK);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 0.9, &t, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_current_mode(hybrid, &mode), SFDAE_OK);
  CHECK(mode == along && fabs(x - 1) < 1e-8);
  CHECK_STATUS(sfdae_get_hybrid_gradient(hybrid, 2, times, 2, weights, gradient), SFDAE_OK);
  CHECK(fabs(gradient[0]) < 1e-8 && fabs(gradient[1] - 0.25) < 1e-8);
  CHECK(fabs(gradient[2] - 1) < 1e-8 && fabs(gradient[3]) < 1e-8);
  CHECK_STATUS(sfdae_get_hybrid_gradient(hybrid, 1, times + 1, 1, weights, gradient), SFDAE_OK);
  CHECK(fabs(gradient[0] - 1) < 1e-8 && fabs(gradient[1]) < 1e-8);
  CHECK_STATUS(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&first), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&second), SFDAE_OK);
}

static void mistakes_are_named(void) {
  sfdae_solver *first = solver_of(rising), *second = solver_of(decaying), *callbacks = solver_of(NULL);
  sfdae_hybrid* hybrid;
  const char *const name = "k", *const unknown = "q";
  const double nan = NAN;
  double x = 0, dt, S;
  sfdae_sensitivity_options how;
  sfdae_options options;
  CHECK_STATUS(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  REFUSED(sfdae_set_hybrid_sensitivities(hybrid, 1, &name, NULL, NULL));
  /* Before a solver becomes a mode, and after. */
  CHECK_STATUS(sfdae_set_sensitivities(first, 1, &name, NULL, NULL), SFDAE_OK);
  REFUSED(sfdae_add_mode(hybrid, first, NULL, NULL));
  CHECK(strstr(sfdae_get_hybrid_message(hybrid), "sfdae_set_hybrid_sensitivities") != NULL);
  CHECK_STATUS(sfdae_set_sensitivities(first, 0, NULL, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(hybrid, first, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_set_sensitivities(first, 1, &name, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(first), "sfdae_set_hybrid_sensitivities") != NULL);
  CHECK_STATUS(sfdae_add_mode(hybrid, second, NULL, NULL), SFDAE_OK);

  REFUSED(sfdae_set_hybrid_sensitivities(hybrid, -1, NULL, NULL, NULL));
  REFUSED(sfdae_set_hybrid_sensitivities(hybrid, 1, &unknown, NULL, NULL));
  CHECK(strstr(sfdae_get_hybrid_message(hybrid), "\"q\"") != NULL);
  REFUSED(sfdae_set_hybrid_sensitivities(hybrid, 1, &name, &nan, NULL));
  sfdae_sensitivity_options_init(&how, sizeof how);
  how.max_kept_steps = 1;
  how.adjoint = 1;
  REFUSED(sfdae_set_hybrid_sensitivities(hybrid, 1, &name, NULL, &how));
  CHECK_STATUS(sfdae_set_hybrid_sensitivities(NULL, 1, &name, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_hybrid_sensitivities(NULL, 0, &S, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_passage_sensitivities(NULL, &dt), SFDAE_ILLEGAL_ARGUMENT);

  /* The error test, whatever the methods of the modes. */
  sfdae_sensitivity_options_init(&how, sizeof how);
  how.error_test = 1;
  CHECK_STATUS(sfdae_set_hybrid_sensitivities(hybrid, 1, &name, NULL, &how), SFDAE_OK);
  sfdae_options_init(&options, sizeof options);
  options.method = SFDAE_METHOD_RADAU;
  CHECK_STATUS(sfdae_set_options(second, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_set_hybrid_sensitivities(hybrid, 1, &name, NULL, &how), SFDAE_OK);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, &x, NULL), SFDAE_OK);

  /* Modes that are functions, in both orders. */
  CHECK_STATUS(sfdae_add_mode(hybrid, callbacks, "callbacks", NULL), SFDAE_OK);
  REFUSED(sfdae_start_hybrid(hybrid, 0, 0, 1, &x, NULL));
  CHECK(strstr(sfdae_get_hybrid_message(hybrid), "callbacks") != NULL);
  REFUSED(sfdae_set_hybrid_sensitivities(hybrid, 1, &name, NULL, NULL));
  CHECK_STATUS(sfdae_set_hybrid_sensitivities(hybrid, 0, NULL, NULL, NULL), SFDAE_OK);
  REFUSED(sfdae_set_hybrid_sensitivities(hybrid, 1, &name, NULL, NULL));
  CHECK_STATUS(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&first), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&second), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&callbacks), SFDAE_OK);
}

int main(void) {
  values_are_those_of_the_formulas();
  values_are_those_along_a_surface();
  gradients_are_those_of_the_formulas();
  gradients_go_back_along_a_surface();
  mistakes_are_named();
  return failures > 0;
}
