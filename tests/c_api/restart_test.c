/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integration: restarts, both directions, output points, stop time, limits on steps, changed options, monitor.
 *
 *     x1' = x2,   x2' = -x1,   x3' = x4,   0 = x3 - x1 - cos(t / 2)       mu = 1, d = 2, a = 2
 *     x = (cos t, -sin t, cos t + cos(t/2), -sin t - sin(t/2) / 2)
 * Solutions that start elsewhere: x1 = C cos(t - p), and so on. Errors neither grow nor decay.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

/* What the callbacks see. */
typedef struct {
  double min_t, max_t;
  int orders; /* 0: order 0 only */
} record;

static int seen(record* r, double t, int order) {
  if (t < r->min_t) r->min_t = t;
  if (t > r->max_t) r->max_t = t;
  return order > 0 && !r->orders ? SFDAE_ORDER_NOT_AVAILABLE : 0;
}

static int E(double t, int order, double* matrix, void* user) {
  if (order == 0) matrix[0] = matrix[5] = matrix[10] = 1;
  return seen((record*)user, t, order);
}

static int A(double t, int order, double* matrix, void* user) {
  if (order == 0) {
    matrix[0 + 4 * 1] = 1;
    matrix[1 + 4 * 0] = -1;
    matrix[2 + 4 * 3] = 1;
    matrix[3 + 4 * 0] = -1;
    matrix[3 + 4 * 2] = 1;
  }
  return seen((record*)user, t, order);
}

static int f(double t, int order, double* vector, void* user) {
  vector[3] = -pow(0.5, order) * cos(t / 2 + order * acos(0.0));
  return seen((record*)user, t, order);
}

static record everything(void) {
  const record r = {HUGE_VAL, -HUGE_VAL, 1};
  return r;
}

static sfdae_options with_tolerance(double tol) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tol;
  return options;
}

static sfdae_solver* create(record* r, const sfdae_options* options) {
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 4;
  problem.E = E;
  problem.A = A;
  problem.f = f;
  problem.user = r;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, options), SFDAE_OK);
  return solver;
}

static void exact(double t, double* x) {
  x[0] = cos(t);
  x[1] = -sin(t);
  x[2] = cos(t) + cos(t / 2);
  x[3] = -sin(t) - sin(t / 2) / 2;
}

static void exact_derivative(double t, double* xdot) {
  xdot[0] = -sin(t);
  xdot[1] = -cos(t);
  xdot[2] = -sin(t) - sin(t / 2) / 2;
  xdot[3] = -cos(t) - cos(t / 2) / 4;
}

/* Within 30 times the tolerance: errors of an undamped oscillation add up over ten units of time. */
static int accurate(double t, const double* x, double tol) {
  double xe[4];
  int i;
  exact(t, xe);
  for (i = 0; i < 4; i++)
    if (!(fabs(x[i] - xe[i]) <= 30 * (tol * fabs(xe[i]) + tol))) return 0;
  return 1;
}

/* Slopes have the error of x over the step size, which is above 1e-2 here. */
static int accurate_derivative(double t, const double* xdot, double tol) {
  double xe[4];
  int i;
  exact_derivative(t, xe);
  for (i = 0; i < 4; i++)
    if (!(fabs(xdot[i] - xe[i]) <= 1000 * tol)) return 0;
  return 1;
}

/* All constraints, the hidden one included. */
static int on_constraints(double t, const double* x) {
  return fabs(x[2] - x[0] - cos(t / 2)) <= 100 * DBL_EPSILON &&
         fabs(x[3] - x[1] + sin(t / 2) / 2) <= 100 * DBL_EPSILON;
}

static sfdae_statistics statistics(const sfdae_solver* solver) {
  sfdae_statistics s;
  sfdae_statistics_init(&s, sizeof s);
  CHECK_STATUS(sfdae_get_statistics(solver, &s), SFDAE_OK);
  return s;
}

static void start(sfdae_solver* solver, double t, double toward) {
  double x[4];
  exact(t, x);
  CHECK_STATUS(sfdae_start(solver, t, toward, x, NULL), SFDAE_OK);
}

/* ---- Output points ---------------------------------------------------------------------------------- */

static void every_output_is_accurate_and_consistent(void) {
  static const double tolerances[] = {1e-3, 1e-6, 1e-9};
  int k, i, direction;
  for (k = 0; k < 3; k++)
    for (direction = -1; direction <= 1; direction += 2) {
      record r = everything();
      sfdae_options options = with_tolerance(tolerances[k]);
      sfdae_solver* solver = create(&r, &options);
      const double t0 = direction > 0 ? 0 : 10;
      double t, x[4], xdot[4];
      sfdae_statistics s;
      start(solver, t0, t0 + 10 * direction);
      for (i = 1; i <= 100; i++) {
        const double tout = t0 + direction * 0.1 * i;
        CHECK_STATUS(sfdae_advance(solver, tout, &t, x, xdot), SFDAE_OK);
        CHECK(t == tout && accurate(t, x, tolerances[k]) && on_constraints(t, x));
        CHECK(accurate_derivative(t, xdot, tolerances[k]));
      }
      s = statistics(solver);
      CHECK(s.steps > 0 && s.steps < 2000 && s.last_order >= 1 && s.last_order <= 5);
      CHECK(direction * s.last_step > 0 && direction * s.next_step > 0 && direction * s.first_step > 0);
      CHECK(direction * (s.t_internal - t) >= 0);
      CHECK(s.evaluations_E > 0 && s.evaluations_A > 0 && s.evaluations_f > 0 && s.reductions > 0);
      sfdae_destroy(&solver);
    }
}

static void points_within_the_last_step_cost_no_step(void) {
  record r = everything();
  sfdae_options options = with_tolerance(1e-6);
  sfdae_solver* solver = create(&r, &options);
  double t, x[4], xdot[4], again[4];
  sfdae_statistics s;
  long steps;
  int i;
  start(solver, 0, 10);
  CHECK_STATUS(sfdae_advance(solver, 5, &t, x, NULL), SFDAE_OK);
  s = statistics(solver);
  steps = s.steps;
  CHECK(s.t_internal >= 5);
  for (i = 1; i <= 10; i++) {
    const double tout = 5 + (s.t_internal - 5) * i / 10;
    CHECK_STATUS(sfdae_advance(solver, tout, &t, x, xdot), SFDAE_OK);
    CHECK(t == tout && accurate(t, x, 1e-6) && on_constraints(t, x) && accurate_derivative(t, xdot, 1e-6));
  }
  CHECK_STATUS(sfdae_advance(solver, t, &t, again, NULL), SFDAE_OK); /* where it is */
  CHECK(memcmp(x, again, sizeof x) == 0);
  CHECK(statistics(solver).steps == steps);
  memset(x, 0, sizeof x);
  t = -1;
  CHECK_STATUS(sfdae_advance(solver, 4.9, &t, x, xdot), SFDAE_ILLEGAL_ARGUMENT); /* back */
  CHECK(t == -1 && x[0] == 0 && x[3] == 0);
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
  CHECK(t == 10 && accurate(t, x, 1e-6));
  sfdae_destroy(&solver);
}

static void start_is_its_own_output(void) {
  record r = everything();
  sfdae_solver* solver = create(&r, NULL);
  double t = -1, x[4], xdot[4], y[4];
  exact(0, x);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 0, &t, y, xdot), SFDAE_OK);
  CHECK(t == 0 && memcmp(x, y, sizeof x) == 0);
  CHECK(accurate_derivative(0, xdot, 1e-6));
  CHECK(statistics(solver).steps == 0);
  CHECK_STATUS(sfdae_advance(solver, 1e-300, &t, y, xdot), SFDAE_OK); /* as good as nowhere */
  CHECK(t == 1e-300 && accurate(t, y, 1e-6));
  CHECK_STATUS(sfdae_advance(solver, 1, &t, y, xdot), SFDAE_OK);
  CHECK(accurate(1, y, 1e-6));
  sfdae_destroy(&solver);
}

/* Output does not influence the steps. */
static void frequent_output_changes_nothing(void) {
  record r = everything();
  sfdae_solver *often = create(&r, NULL), *once = create(&r, NULL);
  double t, x[4], y[4];
  int i;
  start(often, 0, 10);
  start(once, 0, 10);
  for (i = 1; i <= 1000; i++) CHECK_STATUS(sfdae_advance(often, 0.01 * i, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(once, 0.01 * 1000, &t, y, NULL), SFDAE_OK);
  CHECK(memcmp(x, y, sizeof x) == 0);
  CHECK(statistics(often).steps == statistics(once).steps);
  sfdae_destroy(&often);
  sfdae_destroy(&once);
}

static void single_steps_lead_to_tout(void) {
  record r = everything();
  sfdae_solver* solver = create(&r, NULL);
  double t = 0, x[4], xdot[4], before = 0;
  long steps = 0;
  int status;
  start(solver, 0, 10);
  while ((status = sfdae_step(solver, 10, &t, x, xdot)) == SFDAE_STEP_TAKEN) {
    steps++;
    CHECK(t > before && t < 10);
    CHECK(accurate(t, x, 1e-6) && on_constraints(t, x) && accurate_derivative(t, xdot, 1e-6));
    CHECK(statistics(solver).steps == steps);
    CHECK(statistics(solver).t_internal == t);
    before = t;
    if (steps > 10000) break;
  }
  CHECK(status == SFDAE_OK && t == 10 && accurate(t, x, 1e-6) && on_constraints(t, x));
  CHECK(steps > 10);
  sfdae_destroy(&solver);
}

/* ---- Restarts ----------------------------------------------------------------------------------------- */

static void restarts_need_no_new_analysis(void) {
  record r = everything();
  sfdae_solver* solver = create(&r, NULL);
  sfdae_characteristics c;
  double t, x[4];
  sfdae_characteristics_init(&c, sizeof c);
  start(solver, 0, 10);
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
  start(solver, 1, 10); /* back in time */
  CHECK(statistics(solver).steps == 0);
  CHECK_STATUS(sfdae_get_characteristics(solver, &c), SFDAE_OK);
  CHECK(c.t == 0); /* still the first one */
  CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_OK);
  CHECK(accurate(3, x, 1e-6));

  /* From another point: x1 = 2 cos t, x2 = -2 sin t. */
  x[0] = 2, x[1] = 0, x[2] = 3, x[3] = 0;
  CHECK_STATUS(sfdae_start(solver, 0, 10, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_OK);
  CHECK(fabs(x[0] - 2 * cos(3)) <= 10 * (1e-6 * 2 + 1e-6) && fabs(x[1] + 2 * sin(3)) <= 10 * (1e-6 * 2 + 1e-6));
  CHECK(on_constraints(3, x));
  sfdae_destroy(&solver);
}

static void there_and_back_again(void) {
  record r = everything();
  sfdae_solver* solver = create(&r, NULL);
  double t, x[4];
  start(solver, 0, 10);
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, t, 0, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 11, &t, x, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_advance(solver, 0, &t, x, NULL), SFDAE_OK);
  CHECK(t == 0 && accurate(0, x, 2e-6)); /* two ways, twice the error */
  sfdae_destroy(&solver);
}

/* ---- Stop time ------------------------------------------------------------------------------------------ */

static void nothing_is_evaluated_beyond_the_stop_time(void) {
  int direction, differences;
  for (differences = 0; differences <= 1; differences++)
    for (direction = -1; direction <= 1; direction += 2) {
      record r = everything();
      sfdae_options options = with_tolerance(1e-5);
      sfdae_solver* solver;
      const double t0 = 1, stop = t0 + direction * 2;
      double t, x[4];
      int i;
      options.use_stop_time = 1;
      options.stop_time = stop;
      options.difference_derivatives = differences;
      r.orders = !differences;
      solver = create(&r, &options);
      start(solver, t0, stop);
      for (i = 1; i <= 7; i++) {
        const double tout = i == 7 ? stop : t0 + direction * 2.0 * i / 7;
        CHECK_STATUS(sfdae_advance(solver, tout, &t, x, NULL), SFDAE_OK);
        CHECK(t == tout && accurate(t, x, 1e-5));
      }
      CHECK(direction > 0 ? r.max_t <= stop : r.min_t >= stop);
      CHECK(statistics(solver).t_internal == stop);
      t = 99;
      CHECK(sfdae_advance(solver, stop + direction, &t, x, NULL) < 0);
      CHECK(direction > 0 ? r.max_t <= stop : r.min_t >= stop);

      options.use_stop_time = 0; /* on, without a restart */
      CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
      CHECK_STATUS(sfdae_advance(solver, stop + direction, &t, x, NULL), SFDAE_OK);
      CHECK(t == stop + direction && accurate(t, x, 1e-5));
      sfdae_destroy(&solver);
    }
}

/* Only a moment is left: analysis, initial values and steps have to do with it. */
static void stop_time_may_be_close(void) {
  static const double spans[] = {1e-2, 1e-6, 1e-10, 1e-13};
  int k;
  for (k = 0; k < 4; k++) {
    record r = everything();
    sfdae_options options = with_tolerance(1e-6);
    sfdae_solver* solver;
    const double stop = 1 + spans[k];
    double t, x[4];
    options.use_stop_time = 1;
    options.stop_time = stop;
    solver = create(&r, &options);
    start(solver, 1, stop);
    CHECK_STATUS(sfdae_advance(solver, stop, &t, x, NULL), SFDAE_OK);
    CHECK(t == stop && accurate(t, x, 1e-6) && r.max_t <= stop);
    sfdae_destroy(&solver);
  }
}

/* ---- Limits on steps ---------------------------------------------------------------------------------------- */

static void max_steps_interrupts(void) {
  record r = everything();
  sfdae_options options = with_tolerance(1e-6);
  sfdae_solver* solver;
  double t = 0, x[4], before = 0;
  int status, calls = 0;
  options.max_steps = 3;
  solver = create(&r, &options);
  start(solver, 0, 10);
  while ((status = sfdae_advance(solver, 10, &t, x, NULL)) == SFDAE_MAX_STEPS) {
    CHECK(sfdae_message(solver)[0] != 0);
    CHECK(t >= before && t <= 10 && accurate(t, x, 1e-6) && on_constraints(t, x));
    CHECK(statistics(solver).steps <= 3 * ++calls);
    before = t;
    if (calls > 10000) break;
  }
  CHECK(status == SFDAE_OK && t == 10 && accurate(t, x, 1e-6) && calls > 2);
  sfdae_destroy(&solver);
}

typedef struct {
  long calls, stop_at;
  double t, max_step, min_step;
  int max_order;
  double tol;
} observer;

static int observe(const sfdae_progress* progress, void* user) {
  observer* o = (observer*)user;
  o->calls++;
  CHECK(progress->size >= sizeof(sfdae_progress));
  CHECK(progress->num_unknowns == 4 && progress->order >= 1 && progress->order <= 5 && progress->step != 0);
  CHECK(progress->steps == o->calls);
  CHECK(fabs(progress->t - o->t - progress->step) <= 10 * DBL_EPSILON * fmax(1, fabs(progress->t)));
  CHECK(accurate(progress->t, progress->x, o->tol) && on_constraints(progress->t, progress->x));
  o->t = progress->t;
  if (fabs(progress->step) > o->max_step) o->max_step = fabs(progress->step);
  if (fabs(progress->step) < o->min_step) o->min_step = fabs(progress->step);
  if (progress->order > o->max_order) o->max_order = progress->order;
  return o->calls == o->stop_at;
}

static observer observer_with_tolerance(double tol) {
  observer o = {0, 0, 0, 0, HUGE_VAL, 0, 0};
  o.tol = tol;
  return o;
}

static void monitor_sees_every_step(void) {
  int direction;
  for (direction = -1; direction <= 1; direction += 2) {
    record r = everything();
    observer o = observer_with_tolerance(1e-6);
    sfdae_options options = with_tolerance(1e-6);
    sfdae_solver* solver;
    double t, x[4];
    int i;
    options.monitor = observe;
    options.monitor_user = &o;
    solver = create(&r, &options);
    start(solver, 0, 10 * direction);
    CHECK(o.calls == 0);
    for (i = 1; i <= 50; i++) CHECK_STATUS(sfdae_advance(solver, 0.2 * direction * i, &t, x, NULL), SFDAE_OK);
    CHECK(o.calls == statistics(solver).steps && o.t == statistics(solver).t_internal);
    CHECK(o.max_order >= 3);
    sfdae_destroy(&solver);
  }
}

static void monitor_stops_and_the_call_is_repeated(void) {
  record r = everything();
  observer o = observer_with_tolerance(1e-6);
  sfdae_options options = with_tolerance(1e-6);
  sfdae_solver *solver, *undisturbed;
  double t, x[4], y[4];
  undisturbed = create(&r, &options);
  options.monitor = observe;
  options.monitor_user = &o;
  solver = create(&r, &options);
  start(solver, 0, 10);
  start(undisturbed, 0, 10);
  for (o.stop_at = 1; o.stop_at < 20; o.stop_at += 3) {
    CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_STOPPED);
    CHECK(t == o.t && o.calls == o.stop_at && accurate(t, x, 1e-6));
    CHECK(sfdae_message(solver)[0] != 0);
  }
  o.stop_at = 0;
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(undisturbed, 10, &t, y, NULL), SFDAE_OK);
  CHECK(memcmp(x, y, sizeof x) == 0); /* a pause changes nothing */
  sfdae_destroy(&solver);
  sfdae_destroy(&undisturbed);
}

static void steps_obey_their_options(void) {
  record r = everything();
  observer o = observer_with_tolerance(1e-4);
  sfdae_options options = with_tolerance(1e-4);
  sfdae_solver* solver;
  double t, x[4];
  options.monitor = observe;
  options.monitor_user = &o;
  options.max_step = 0.01;
  solver = create(&r, &options);
  start(solver, 0, 2);
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
  CHECK(o.max_step <= 0.01 * (1 + 4 * DBL_EPSILON) && o.calls >= 200);

  options.max_step = 0; /* no limit, but low order */
  options.max_order = 2;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  o = observer_with_tolerance(1e-3); /* many steps of low order, each with an error near the tolerance */
  start(solver, 0, 2);
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
  CHECK(o.max_step > 0.01 && o.max_order == 2);
  sfdae_destroy(&solver);
}

static void first_step_may_be_given(void) {
  int direction;
  for (direction = -1; direction <= 1; direction += 2) {
    record r = everything();
    sfdae_options options = with_tolerance(1e-5);
    sfdae_solver* solver;
    double t, x[4];
    options.initial_step = 1e-4; /* accurate enough to be accepted: its local error is below 1e-8 */
    solver = create(&r, &options);
    start(solver, 0, 5 * direction);
    CHECK_STATUS(sfdae_advance(solver, direction, &t, x, NULL), SFDAE_OK);
    CHECK(fabs(statistics(solver).first_step - direction * 1e-4) <= 4 * DBL_EPSILON * 1e-4);
    CHECK(accurate(t, x, 1e-5));
    sfdae_destroy(&solver);
  }
}

static void first_step_that_is_too_long_is_reduced(void) {
  record r = everything();
  sfdae_options options = with_tolerance(1e-6);
  sfdae_solver* solver;
  double t, x[4];
  options.initial_step = 100;
  solver = create(&r, &options);
  start(solver, 0, 200);
  CHECK_STATUS(sfdae_advance(solver, 5, &t, x, NULL), SFDAE_OK);
  CHECK(t == 5 && accurate(t, x, 1e-6) && statistics(solver).first_step < 1);
  CHECK(statistics(solver).error_failures + statistics(solver).other_failures > 0);
  sfdae_destroy(&solver);
}

/* ---- Changed options ------------------------------------------------------------------------------------------ */

static void options_may_change_on_the_way(void) {
  static const double vector[4] = {1e-8, 1e-8, 1e-8, 1e-8};
  record r = everything();
  sfdae_options options = with_tolerance(1e-4);
  sfdae_solver* solver = create(&r, &options);
  double t, x[4];
  start(solver, 0, 10);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  options.max_order = 3;
  options.max_step = 0.05;
  options.rtol_vector = options.atol_vector = vector;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
  CHECK(t == 2 && accurate(t, x, 1e-4) && fabs(statistics(solver).last_step) <= 0.05 * (1 + 4 * DBL_EPSILON));
  sfdae_destroy(&solver);
}

static void options_of_the_analysis_need_a_new_start(void) {
  int which;
  for (which = 0; which < 7; which++) {
    record r = everything();
    sfdae_options options = with_tolerance(1e-6);
    sfdae_solver* solver = create(&r, &options);
    double t = -1, x[4] = {7, 7, 7, 7};
    start(solver, 0, 10);
    CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK); /* the same ones: nothing happens */
    CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
    switch (which) {
      case 0: options.max_index = 3; break;
      case 1: options.reduction = SFDAE_REDUCTION_SVD; break;
      case 2: options.rank_tol = 1e-9; break;
      case 3: options.time_scale = 0.5; break;
      case 4: options.difference_derivatives = 1; break;
      case 5: options.difference_step = 1e-2; break;
      default: options.leading_term = SFDAE_LEADING_MATRIX; break;
    }
    CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
    t = -1;
    memset(x, 0, sizeof x);
    CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_NOT_STARTED);
    CHECK(t == -1 && x[0] == 0 && x[3] == 0);
    start(solver, 1, 10);
    CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
    CHECK(t == 2 && accurate(t, x, 1e-6));
    sfdae_destroy(&solver);
  }
}

static void tolerances_below_rounding_are_refused_or_met(void) {
  record r = everything();
  sfdae_options options = with_tolerance(1e-300);
  sfdae_solver* solver = create(&r, &options);
  double t = -1, x[4];
  int status;
  exact(0, x);
  status = sfdae_start(solver, 0, 1, x, NULL);
  if (status == SFDAE_OK) status = sfdae_advance(solver, 1, &t, x, NULL);
  CHECK_STATUS(status, SFDAE_TOLERANCE_TOO_SMALL);
  CHECK(sfdae_message(solver)[0] != 0);
  options = with_tolerance(1e-6);
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  start(solver, 0, 1);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(accurate(t, x, 1e-6));
  sfdae_destroy(&solver);
}

int main(void) {
  every_output_is_accurate_and_consistent();
  points_within_the_last_step_cost_no_step();
  start_is_its_own_output();
  frequent_output_changes_nothing();
  single_steps_lead_to_tout();
  restarts_need_no_new_analysis();
  there_and_back_again();
  nothing_is_evaluated_beyond_the_stop_time();
  stop_time_may_be_close();
  max_steps_interrupts();
  monitor_sees_every_step();
  monitor_stops_and_the_call_is_repeated();
  steps_obey_their_options();
  first_step_may_be_given();
  first_step_that_is_too_long_is_reduced();
  options_may_change_on_the_way();
  options_of_the_analysis_need_a_new_start();
  tolerances_below_rounding_are_refused_or_met();
  return failures != 0;
}
