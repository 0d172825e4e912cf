/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Arguments that are refused change nothing: outputs are untouched, and an integration under way goes on in every bit.
 *
 *     x1' = x2,   x2' = -p x1,   0 = x3 - x1 - cos t       recorded; with p = 1: x = (cos t, -sin t, 2 cos t)
 *
 * and a pendulum, nonlinear. */
#include "checks.h"

#include <math.h>
#include <string.h>

enum { N = 3, LONGEST = 4000 };

static int oscillator(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                      const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression p = sfdae_parameter(record, "p", 1);
  (void)user;
  F[0] = sfdae_subtract(xdot[0], x[1]);
  F[1] = sfdae_add(xdot[1], sfdae_multiply(p, x[0]));
  F[2] = sfdae_subtract(x[2], sfdae_add(x[0], sfdae_cos(t)));
  return 0;
}

/* 0 = x3^3 + x3 - x1: nonlinear. */
static int cubic(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                 sfdae_expression* F, void* user) {
  oscillator(record, t, x, xdot, F, user);
  F[2] = sfdae_subtract(sfdae_add(sfdae_power(x[2], sfdae_number(3)), x[2]), x[0]);
  return 0;
}

static int sign_of_x1(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = x[0];
  return 0;
}

static sfdae_options options_of(int method) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.method = method;
  options.use_stop_time = 1, options.stop_time = 3;
  return options;
}

/* At t = 1 on its way to 3. */
static sfdae_solver* create_and_advance(sfdae_equations_function equations, int method) {
  const sfdae_options options = options_of(method);
  sfdae_nonlinear_problem problem;
  sfdae_solver* solver = NULL;
  double t = 0, x[N] = {1, 0, 0.7};
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = N;
  problem.equations = equations;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_set_events(solver, 1, sign_of_x1, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 3, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  return solver;
}

typedef struct {
  double values[LONGEST];
  size_t length;
} state;

static void save(sfdae_solver* solver, state* s) {
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, &s->length), SFDAE_OK);
  if (s->length > LONGEST) abort();
  CHECK_STATUS(sfdae_save_checkpoint(solver, s->values, s->length), SFDAE_OK);
}

/* The call is refused, says why, and leaves the integration as it was. */
static state before, after;
#define REFUSED(call)                                                                         \
  do {                                                                                        \
    save(solver, &before);                                                                    \
    CHECK_STATUS(call, SFDAE_ILLEGAL_ARGUMENT);                                               \
    CHECK(sfdae_message(solver)[0] != 0);                                                     \
    save(solver, &after);                                                                     \
    CHECK(before.length == after.length &&                                                    \
          memcmp(before.values, after.values, before.length * sizeof before.values[0]) == 0); \
  } while (0)

static const double kept[N] = {0.5, 0.25, 0.125}; /* what outputs hold */

static void options_and_events(sfdae_solver* solver, int method) {
  const int wrong_direction = 2;
  sfdae_options options = options_of(method);
  REFUSED(sfdae_set_options(solver, NULL));
  options.rtol = -1;
  REFUSED(sfdae_set_options(solver, &options));
  options = options_of(method), options.max_index = 99;
  REFUSED(sfdae_set_options(solver, &options));
  options = options_of(method), options.size = 0;
  REFUSED(sfdae_set_options(solver, &options));
  REFUSED(sfdae_set_events(solver, -1, sign_of_x1, NULL, NULL));
  REFUSED(sfdae_set_events(solver, 1, NULL, NULL, NULL));
  REFUSED(sfdae_set_events(solver, 1, sign_of_x1, &wrong_direction, NULL));
  REFUSED(sfdae_set_parameter(solver, "q", 1));
  REFUSED(sfdae_set_parameter(solver, NULL, 1));
  REFUSED(sfdae_set_parameter(solver, "p", NAN));
}

static void analyses_and_starts(sfdae_solver* solver) {
  double x[N], xdot[N], bad[N] = {1, NAN, 0};
  sfdae_characteristics c, unset;
  sfdae_characteristics_init(&c, sizeof c);
  c.differential = 77, unset.size = 0;
  memcpy(x, kept, sizeof x), memcpy(xdot, kept, sizeof xdot);
  REFUSED(sfdae_analyze(solver, NAN, 1, &c));
  REFUSED(sfdae_analyze(solver, 1, 1, &c));
  REFUSED(sfdae_analyze(solver, 3, 4, &c)); /* at the stop time */
  REFUSED(sfdae_analyze(solver, 1, 2, &unset));
  REFUSED(sfdae_analyze_at(solver, 1, 2, NULL, &c));
  REFUSED(sfdae_analyze_at(solver, 1, 2, bad, &c));
  REFUSED(sfdae_analyze_at(solver, 1, 1, x, &c));
  REFUSED(sfdae_make_consistent(solver, NAN, x, xdot));
  REFUSED(sfdae_make_consistent(solver, 1, NULL, xdot));
  REFUSED(sfdae_make_consistent(solver, 1, bad, xdot));
  REFUSED(sfdae_start(solver, NAN, 2, x, xdot));
  REFUSED(sfdae_start(solver, 1, INFINITY, x, xdot));
  REFUSED(sfdae_start(solver, 1, 1, x, xdot));
  REFUSED(sfdae_start(solver, 1, 2, NULL, xdot));
  REFUSED(sfdae_start(solver, 1, 2, bad, xdot));
  REFUSED(sfdae_start(solver, 3, 4, x, xdot)); /* at the stop time, and beyond it */
  REFUSED(sfdae_start(solver, 4, 5, x, xdot));
  REFUSED(sfdae_start(solver, 2.5, 2, x, xdot)); /* backward, with the stop time behind */
  CHECK(memcmp(x, kept, sizeof x) == 0 && memcmp(xdot, kept, sizeof xdot) == 0 && c.differential == 77);
}

static void steps_and_checkpoints(sfdae_solver* solver) {
  double t = 0.75, x[N], xdot[N];
  size_t length = 0;
  static state other;
  memcpy(x, kept, sizeof x), memcpy(xdot, kept, sizeof xdot);
  REFUSED(sfdae_advance(solver, 0.5, &t, x, xdot)); /* back */
  REFUSED(sfdae_advance(solver, 3.5, &t, x, xdot)); /* beyond the stop time */
  REFUSED(sfdae_advance(solver, NAN, &t, x, xdot));
  REFUSED(sfdae_advance(solver, 2, NULL, x, xdot));
  REFUSED(sfdae_advance(solver, 2, &t, NULL, xdot));
  REFUSED(sfdae_step(solver, 0.5, &t, x, xdot));
  REFUSED(sfdae_step(solver, 3.5, &t, x, xdot));
  REFUSED(sfdae_step(solver, 2, &t, NULL, xdot));
  REFUSED(sfdae_interpolate(solver, -1, x, xdot));
  REFUSED(sfdae_interpolate(solver, 2.9, x, xdot));
  REFUSED(sfdae_interpolate(solver, 1, NULL, xdot));
  REFUSED(sfdae_get_checkpoint_length(solver, NULL));
  REFUSED(sfdae_save_checkpoint(solver, x, N));
  save(solver, &other);
  REFUSED(sfdae_restore_checkpoint(solver, NULL, other.length));
  REFUSED(sfdae_restore_checkpoint(solver, other.values, other.length - 1));
  for (length = 0; length < other.length; length++) {
    const double intact = other.values[length];
    other.values[length] = intact + 1.5;
    if (other.values[length] != intact) REFUSED(sfdae_restore_checkpoint(solver, other.values, other.length));
    other.values[length] = intact;
  }
  CHECK(t == 0.75 && memcmp(x, kept, sizeof x) == 0 && memcmp(xdot, kept, sizeof xdot) == 0);
}

/* Without events there is another checkpoint: it is refused only once it has been read to the end. */
static void checkpoint_of_other_events(sfdae_solver* solver) {
  static state other;
  CHECK_STATUS(sfdae_set_events(solver, 0, NULL, NULL, NULL), SFDAE_OK);
  save(solver, &other);
  CHECK_STATUS(sfdae_set_events(solver, 1, sign_of_x1, NULL, NULL), SFDAE_OK);
  REFUSED(sfdae_restore_checkpoint(solver, other.values, other.length));
}

static void inspections(sfdae_solver* solver) {
  sfdae_derivative_check check;
  int vhat = 77;
  sfdae_derivative_check_init(&check, sizeof check);
  REFUSED(sfdae_get_derivative_array(solver, 1, -1, NULL, NULL, NULL));
  REFUSED(sfdae_get_derivative_array(solver, 1, 99, NULL, NULL, NULL));
  REFUSED(sfdae_get_projectors(solver, NAN, NULL, NULL, NULL, NULL, &vhat));
  REFUSED(sfdae_get_strangeness_free(solver, NAN, NULL, NULL, NULL, NULL, NULL, NULL));
  REFUSED(sfdae_check_derivatives(solver, 1, 0, &check));
  REFUSED(sfdae_check_derivatives(solver, 1, 1, NULL));
  CHECK(vhat == 77);
}

static void refusals_change_nothing(sfdae_equations_function equations, int method) {
  sfdae_solver *solver = create_and_advance(equations, method), *undisturbed = create_and_advance(equations, method);
  double t = 0, u = 0, x[N], y[N], xdot[N], ydot[N];
  int status;
  options_and_events(solver, method);
  analyses_and_starts(solver);
  steps_and_checkpoints(solver);
  inspections(solver);
  do {
    status = sfdae_advance(undisturbed, 3, &u, y, ydot);
    CHECK_STATUS(sfdae_advance(solver, 3, &t, x, xdot), status);
    CHECK(t == u && memcmp(x, y, sizeof x) == 0 && memcmp(xdot, ydot, sizeof xdot) == 0);
  } while (status == SFDAE_EVENT);
  CHECK(status == SFDAE_OK);
  checkpoint_of_other_events(solver);
  sfdae_destroy(&solver);
  sfdae_destroy(&undisturbed);
}

/* Failures of another kind end what was under way, as the header says; so does a start that succeeds. */
static void other_failures_of_a_start_end_the_integration(void) {
  sfdae_solver* solver = create_and_advance(oscillator, SFDAE_METHOD_BDF);
  sfdae_options options = options_of(SFDAE_METHOD_BDF);
  double t, x[N] = {1, 0, 5};
  options.initial_values = SFDAE_INITIAL_ACCEPT;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 1, 2, x, NULL), SFDAE_INCONSISTENT_VALUES);
  CHECK(x[2] == 5);
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_NOT_STARTED);
  sfdae_destroy(&solver);
}

int main(void) {
  const int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC};
  int i;
  for (i = 0; i < 3; i++) {
    refusals_change_nothing(oscillator, methods[i]);
    refusals_change_nothing(cubic, methods[i]);
  }
  other_failures_of_a_start_end_the_integration();
  return failures > 0;
}
