/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The methods behind `method`: Radau IIA with its numbers of stages, and the automatic choice.
 *
 *     s x1' = s x2,   x2' = -x1,   x3' = x4,   0 = x3 - x1 - cos(t / 2),   s = 2 + sin t        mu = 1, d = 2, a = 2
 *     x = (cos t, -sin t, cos t + cos(t/2), -sin t - sin(t/2) / 2)
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

/* ---- Methods and problem ------------------------------------------------------------------------ */

typedef struct {
  int method, min_stages, max_stages;
} choice;
static const choice choices[] = {{SFDAE_METHOD_RADAU, 1, 7},
                                 {SFDAE_METHOD_RADAU, 3, 3},
                                 {SFDAE_METHOD_RADAU, 5, 5},
                                 {SFDAE_METHOD_RADAU, 7, 7},
                                 {SFDAE_METHOD_AUTOMATIC, 1, 7}};
enum { CHOICES = sizeof choices / sizeof choices[0], N = 4 };

/* What the callbacks see. */
typedef struct {
  double min_t, max_t;
  double wobble; /* of s */
  int no_orders; /* 1: order 0 only */
  long calls;
  long stop_at; /* the call that asks `solver` to stop */
  sfdae_solver* solver;
} record;

static int seen(record* r, double t, int order) {
  r->min_t = fmin(r->min_t, t);
  r->max_t = fmax(r->max_t, t);
  if (++r->calls == r->stop_at) CHECK_STATUS(sfdae_request_stop(r->solver), SFDAE_OK);
  return order > 0 && r->no_orders ? SFDAE_ORDER_NOT_AVAILABLE : 0;
}

static double s(const record* r, double t, int order) {
  return (order == 0 ? 2 : 0) + r->wobble * sin(t + order * acos(0.0));
}

static int E(double t, int order, double* matrix, void* user) {
  matrix[0] = s((record*)user, t, order);
  if (order == 0) matrix[5] = matrix[10] = 1;
  return seen((record*)user, t, order);
}

static int A(double t, int order, double* matrix, void* user) {
  matrix[0 + N * 1] = s((record*)user, t, order);
  if (order == 0) matrix[1 + N * 0] = matrix[3 + N * 0] = -1, matrix[2 + N * 3] = matrix[3 + N * 2] = 1;
  return seen((record*)user, t, order);
}

static int f(double t, int order, double* vector, void* user) {
  vector[3] = -pow(0.5, order) * cos(t / 2 + order * acos(0.0));
  return seen((record*)user, t, order);
}

static record everything(void) {
  const record r = {HUGE_VAL, -HUGE_VAL, 1, 0, 0, 0, NULL};
  return r;
}

static sfdae_options options_for(choice c, double tol) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tol;
  options.method = c.method, options.min_stages = c.min_stages, options.max_stages = c.max_stages;
  return options;
}

static sfdae_linear_problem problem_with(record* r) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = N;
  problem.E = E, problem.A = A, problem.f = f;
  problem.user = r;
  return problem;
}

static sfdae_solver* create(record* r, const sfdae_options* options) {
  const sfdae_linear_problem problem = problem_with(r);
  CHECK_STATUS(sfdae_create_linear(&r->solver, &problem, options), SFDAE_OK);
  return r->solver;
}

static void exact(double t, double* x, double* xdot) {
  x[0] = cos(t), x[1] = -sin(t), x[2] = cos(t) + cos(t / 2), x[3] = -sin(t) - sin(t / 2) / 2;
  xdot[0] = -sin(t), xdot[1] = -cos(t), xdot[2] = x[3], xdot[3] = -cos(t) - cos(t / 2) / 4;
}

/* Largest error of x in units of the tolerance. */
static double error_of(double t, const double* x, double tol) {
  double xe[N], xdote[N], largest = 0;
  int i;
  exact(t, xe, xdote);
  for (i = 0; i < N; i++) largest = fmax(largest, fabs(x[i] - xe[i]) / (tol * fabs(xe[i]) + tol));
  return largest;
}

static double slope_error_of(double t, const double* xdot) {
  double xe[N], xdote[N], largest = 0;
  int i;
  exact(t, xe, xdote);
  for (i = 0; i < N; i++) largest = fmax(largest, fabs(xdot[i] - xdote[i]));
  return largest;
}

static int accurate(double t, const double* x, double tol) { return error_of(t, x, tol) <= 10; }

/* All constraints, the hidden one included. */
static int on_constraints(double t, const double* x) {
  return fabs(x[2] - x[0] - cos(t / 2)) <= 100 * DBL_EPSILON &&
         fabs(x[3] - x[1] + sin(t / 2) / 2) <= 100 * DBL_EPSILON;
}

static void start(sfdae_solver* solver, double t, double toward) {
  double x[N], xdot[N];
  exact(t, x, xdot);
  CHECK_STATUS(sfdae_start(solver, t, toward, x, NULL), SFDAE_OK);
}

static sfdae_statistics statistics(const sfdae_solver* solver) {
  sfdae_statistics result;
  sfdae_statistics_init(&result, sizeof result);
  CHECK_STATUS(sfdae_get_statistics(solver, &result), SFDAE_OK);
  return result;
}

static int report_contains(const sfdae_solver* solver, const char* words) {
  char text[8000];
  CHECK_STATUS(sfdae_report(solver, text, sizeof text, NULL), SFDAE_OK);
  return strstr(text, words) != NULL;
}

/* ---- Options ----------------------------------------------------------------------------------------- */

/* Refused at creation, by the check and later; an integration under way does not notice. */
static void illegal_methods_and_stages_are_refused(void) {
  static const choice wrong[] = {{-1, 1, 7},
                                 {3, 1, 7},
                                 {1000000, 1, 7},
                                 {SFDAE_METHOD_RADAU, 0, 7},
                                 {SFDAE_METHOD_RADAU, -1, 7},
                                 {SFDAE_METHOD_RADAU, 2, 7},
                                 {SFDAE_METHOD_RADAU, 1, 4},
                                 {SFDAE_METHOD_RADAU, 1, 9},
                                 {SFDAE_METHOD_RADAU, 9, 9},
                                 {SFDAE_METHOD_RADAU, 5, 3},
                                 {SFDAE_METHOD_RADAU, 1, 0},
                                 {SFDAE_METHOD_BDF, 0, 0},
                                 {SFDAE_METHOD_AUTOMATIC, 7, 1}};
  size_t i;
  for (i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    record r = everything(), q = everything();
    const sfdae_linear_problem problem = problem_with(&r);
    const sfdae_options bad = options_for(wrong[i], 1e-3), good = options_for(choices[0], 1e-6);
    sfdae_solver *solver = (sfdae_solver*)(void*)&r, *undisturbed;
    double t, x[N], y[N];
    char text[512];
    CHECK_STATUS(sfdae_create_linear(&solver, &problem, &bad), SFDAE_ILLEGAL_ARGUMENT);
    CHECK(solver == NULL);
    CHECK_STATUS(sfdae_check_linear(&problem, &bad, text, sizeof text), SFDAE_ILLEGAL_ARGUMENT);
    CHECK(strstr(text, wrong[i].min_stages == 1 && wrong[i].max_stages == 7 ? "method" : "stages") != NULL);
    solver = create(&r, &good), undisturbed = create(&q, &good);
    start(solver, 0, 4), start(undisturbed, 0, 4);
    CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(undisturbed, 1, &t, y, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_set_options(solver, &bad), SFDAE_ILLEGAL_ARGUMENT);
    CHECK_STATUS(sfdae_advance(solver, 4, &t, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(undisturbed, 4, &t, y, NULL), SFDAE_OK);
    CHECK(memcmp(x, y, sizeof x) == 0);
    sfdae_destroy(&solver);
    sfdae_destroy(&undisturbed);
  }
}

static void a_new_method_takes_effect_with_the_next_start(void) {
  int from, to;
  for (from = SFDAE_METHOD_BDF; from <= SFDAE_METHOD_RADAU; from++)
    for (to = SFDAE_METHOD_BDF; to <= SFDAE_METHOD_AUTOMATIC; to++) {
      const choice before = {from, 1, 7}, after = {to, 1, 7};
      const char* const name = from == SFDAE_METHOD_BDF ? "by BDF" : "by Radau IIA";
      record r = everything();
      sfdae_options options = options_for(before, 1e-6);
      sfdae_solver* solver = create(&r, &options);
      double t, x[N];
      int k;
      start(solver, 0, 10);
      CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
      options = options_for(after, 1e-6);
      CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
      for (k = 1; k <= 900; k++) CHECK_STATUS(sfdae_advance(solver, 1 + 0.01 * k, &t, x, NULL), SFDAE_OK);
      CHECK(accurate(t, x, 1e-6) && report_contains(solver, name));
      start(solver, 0, 10);
      CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
      CHECK(accurate(t, x, 1e-6) && report_contains(solver, to == SFDAE_METHOD_BDF ? "by BDF" : "by Radau IIA"));
      sfdae_destroy(&solver);
    }
}

/* Likewise other numbers of stages. */
static void new_stages_take_effect_with_the_next_start(void) {
  static const int stages[] = {1, 7, 3, 5, 3, 7, 1};
  const choice first = {SFDAE_METHOD_RADAU, 1, 1};
  record r = everything();
  sfdae_options options = options_for(first, 1e-4);
  sfdae_solver* solver = create(&r, &options);
  double t, x[N];
  int k, i;
  for (k = 0; k < 6; k++) {
    const int order = 2 * stages[k] - 1;
    start(solver, 0, 10);
    CHECK_STATUS(sfdae_step(solver, 10, &t, x, NULL), SFDAE_STEP_TAKEN);
    CHECK(statistics(solver).last_order == order);
    options.min_stages = options.max_stages = stages[k + 1];
    CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
    for (i = 0; i < 10 && t < 10; i++) {
      CHECK(sfdae_step(solver, 100, &t, x, NULL) == SFDAE_STEP_TAKEN);
      CHECK(accurate(t, x, 1e-4) && on_constraints(t, x));
      CHECK(statistics(solver).last_order == order && statistics(solver).next_order == order);
    }
  }
  sfdae_destroy(&solver);
}

/* ---- Orders -------------------------------------------------------------------------------------------- */

typedef struct {
  long calls, stop_at;
  int order_1; /* errors of steps of order 1 add up */
  double t, tol;
  int lowest, highest; /* order */
} observer;

static int observe(const sfdae_progress* progress, void* user) {
  observer* o = (observer*)user;
  o->calls++;
  CHECK(progress->num_unknowns == N && progress->steps == o->calls);
  CHECK(fabs(progress->t - o->t - progress->step) <= 10 * DBL_EPSILON * fmax(1, fabs(progress->t)));
  CHECK(on_constraints(progress->t, progress->x));
  CHECK(accurate(progress->t, progress->x, o->order_1 ? o->tol * (double)progress->steps : o->tol));
  o->t = progress->t;
  if (progress->order < o->lowest) o->lowest = progress->order;
  if (progress->order > o->highest) o->highest = progress->order;
  return o->calls == o->stop_at;
}

static observer observer_with_tolerance(double tol) {
  observer o = {0, 0, 0, 0, 0, 1000, 0};
  o.tol = tol;
  return o;
}

static void fixed_numbers_of_stages_have_their_orders(void) {
  int stages;
  for (stages = 1; stages <= 7; stages += 2) {
    const choice fixed = {SFDAE_METHOD_RADAU, stages, stages};
    record r = everything();
    observer o = observer_with_tolerance(1e-4);
    sfdae_options options = options_for(fixed, 1e-4);
    sfdae_solver* solver;
    char name[64];
    double t, x[N];
    o.order_1 = stages == 1;
    options.monitor = observe, options.monitor_user = &o;
    solver = create(&r, &options);
    start(solver, 0, 10);
    CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
    CHECK(o.lowest == 2 * stages - 1 && o.highest == 2 * stages - 1);
    CHECK(statistics(solver).last_order == 2 * stages - 1 && statistics(solver).next_order == 2 * stages - 1);
    sprintf(name, "Radau IIA with %d stage%s:", stages, stages > 1 ? "s" : "");
    CHECK(report_contains(solver, name));
    sfdae_destroy(&solver);
  }
}

/* The error at t = 8 with steps of size h: C h^p up to higher powers of h, p = 2s - 1. */
static double error_with_step(int stages, double h) {
  const choice fixed = {SFDAE_METHOD_RADAU, stages, stages};
  record r = everything();
  sfdae_options options = options_for(fixed, 0.9);
  sfdae_solver* solver;
  double t, x[N];
  r.wobble = 0; /* 1 / (1 + s^2) has poles near the real axis, which hide the order of long steps */
  options.initial_step = options.max_step = h;
  options.use_stop_time = 1, options.stop_time = 8;
  solver = create(&r, &options);
  start(solver, 0, 8);
  CHECK_STATUS(sfdae_advance(solver, 8, &t, x, NULL), SFDAE_OK);
  CHECK(statistics(solver).steps == (long)(8 / h));
  sfdae_destroy(&solver);
  return error_of(t, x, 1);
}

static void halving_the_step_shows_the_order(void) {
  static const double steps[] = {1.0 / 64, 0.5, 2, 4};
  int i;
  for (i = 0; i < 4; i++) {
    const int stages = 2 * i + 1;
    const double coarse = error_with_step(stages, steps[i]), fine = error_with_step(stages, steps[i] / 2);
    const double order = log(coarse / fine) / log(2);
    if (!(fabs(order - (2 * stages - 1)) <= 0.5)) {
      failures++;
      fprintf(stderr, "%s:%d: %d stages: %g, %g: order %g\n", __FILE__, __LINE__, stages, coarse, fine, order);
    }
  }
}

/* Many stages where tolerances are tight, and then fewer steps than BDF needs. */
static void stages_are_chosen_to_suit_the_tolerance(void) {
  static const choice bdf = {SFDAE_METHOD_BDF, 1, 7};
  const double tol = 1e-10;
  record r = everything(), q = everything();
  observer o = observer_with_tolerance(tol);
  sfdae_options options = options_for(choices[0], tol), others = options_for(bdf, tol);
  sfdae_solver *solver, *other = create(&q, &others);
  double t, x[N];
  options.monitor = observe, options.monitor_user = &o;
  solver = create(&r, &options);
  start(solver, 0, 10), start(other, 0, 10);
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(other, 10, &t, x, NULL), SFDAE_OK);
  CHECK(o.lowest >= 5 && o.highest >= 9);
  CHECK(5 * statistics(solver).steps < statistics(other).steps);
  sfdae_destroy(&solver);
  sfdae_destroy(&other);

  o = observer_with_tolerance(1e-2);
  options.rtol = options.atol = 1e-2;
  solver = create(&r, &options);
  start(solver, 0, 10);
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
  CHECK(o.highest <= 9);
  sfdae_destroy(&solver);
}

/* ---- Output ------------------------------------------------------------------------------------------------ */

/* Slopes have the error of x over the step size; |x| <= 2, so that tolerances are 3 tol at most. */
static void every_output_is_accurate_and_consistent(void) {
  static const double tolerances[] = {1e-3, 1e-6, 1e-9};
  int k, i, c, direction;
  for (c = 0; c < CHOICES; c++)
    for (k = 0; k < 3; k++)
      for (direction = -1; direction <= 1; direction += 2) {
        const double t0 = direction > 0 ? 0 : 10, tol = tolerances[k];
        record r = everything();
        const sfdae_options options = options_for(choices[c], tol);
        sfdae_solver* solver = create(&r, &options);
        double t, x[N], xdot[N], worst = 0, worst_slope = 0;
        sfdae_statistics found;
        start(solver, t0, t0 + 10 * direction);
        for (i = 1; i <= 100; i++) {
          const double tout = t0 + direction * 0.1 * i;
          CHECK_STATUS(sfdae_advance(solver, tout, &t, x, xdot), SFDAE_OK);
          CHECK(t == tout && on_constraints(t, x));
          found = statistics(solver);
          worst = fmax(worst, error_of(t, x, tol));
          worst_slope = fmax(worst_slope, fabs(found.last_step) * slope_error_of(t, xdot) / tol);
        }
        CHECK(direction * found.last_step > 0 && direction * found.next_step > 0 && direction * found.first_step > 0);
        if (worst > 10 || worst_slope > 10 * 3) {
          failures++;
          fprintf(stderr, "%s:%d: choice %d, tol %g, direction %d: error %g tolerances, of h x' %g\n", __FILE__,
                  __LINE__, c, tol, direction, worst, worst_slope);
        }
        sfdae_destroy(&solver);
      }
}

/* The first steps end at outputs, as there is no past for an accurate polynomial yet; later outputs are interpolated.
 * */
static void frequent_output_hardly_changes_the_steps(void) {
  int c;
  for (c = 0; c < CHOICES; c++) {
    const long first = choices[c].max_stages + 1;
    record r = everything(), q = everything();
    sfdae_options options = options_for(choices[c], 1e-6);
    sfdae_solver *often, *once;
    double t, x[N];
    int i;
    if (options.method == SFDAE_METHOD_AUTOMATIC) continue;
    options.use_stop_time = 1, options.stop_time = 10;
    often = create(&r, &options), once = create(&q, &options);
    start(often, 0, 10), start(once, 0, 10);
    for (i = 1; i <= 1000; i++) CHECK_STATUS(sfdae_advance(often, i == 1000 ? 10 : 0.01 * i, &t, x, NULL), SFDAE_OK);
    CHECK(accurate(t, x, 1e-6));
    CHECK_STATUS(sfdae_advance(once, 10, &t, x, NULL), SFDAE_OK);
    CHECK(statistics(often).steps <= statistics(once).steps + 2 * first);
    CHECK(statistics(often).error_failures <= statistics(once).error_failures + first);
    sfdae_destroy(&often);
    sfdae_destroy(&once);
  }
}

static void single_steps_lead_to_tout(void) {
  int c;
  for (c = 0; c < CHOICES; c++) {
    record r = everything();
    const sfdae_options options = options_for(choices[c], 1e-6);
    sfdae_solver* solver = create(&r, &options);
    double t = 0, x[N], xdot[N], before = 0;
    long steps = 0;
    int status;
    start(solver, 0, 10);
    while ((status = sfdae_step(solver, 10, &t, x, xdot)) == SFDAE_STEP_TAKEN) {
      steps++;
      CHECK(t > before && t < 10);
      CHECK(accurate(t, x, 1e-6) && on_constraints(t, x));
      CHECK(slope_error_of(t, xdot) <= 10 * 2e-6 / (t - before));
      CHECK(statistics(solver).steps == steps && statistics(solver).t_internal == t);
      before = t;
      if (steps > 10000) break;
    }
    CHECK(status == SFDAE_OK && t == 10 && accurate(t, x, 1e-6) && on_constraints(t, x) && steps > 1);
    sfdae_destroy(&solver);
  }
}

static void there_and_back_again(void) {
  int c;
  for (c = 0; c < CHOICES; c++) {
    record r = everything();
    const sfdae_options options = options_for(choices[c], 1e-6);
    sfdae_solver* solver = create(&r, &options);
    double t, x[N];
    start(solver, 0, 10);
    CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_start(solver, t, 0, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(solver, 11, &t, x, NULL), SFDAE_ILLEGAL_ARGUMENT);
    CHECK_STATUS(sfdae_advance(solver, 0, &t, x, NULL), SFDAE_OK);
    CHECK(t == 0 && accurate(0, x, 2e-6)); /* two ways, twice the error */
    CHECK(statistics(solver).last_step < 0);
    sfdae_destroy(&solver);
  }
}

/* Polynomials of several stages serve any number of outputs, steps of one stage have none. */
static void automatic_is_bdf_where_output_is_too_frequent(void) {
  const choice automatic = {SFDAE_METHOD_AUTOMATIC, 1, 7};
  record r = everything();
  sfdae_options options = options_for(automatic, 1e-6);
  sfdae_solver* solver = create(&r, &options);
  double t, x[N];
  int i;
  start(solver, 0, 10);
  for (i = 1; i <= 10; i++) CHECK_STATUS(sfdae_advance(solver, i, &t, x, NULL), SFDAE_OK);
  CHECK(report_contains(solver, "by Radau IIA with") && report_contains(solver, "(chosen automatically)"));
  start(solver, 0, 10);
  for (i = 1; i <= 1000; i++) {
    CHECK_STATUS(sfdae_advance(solver, 0.01 * i, &t, x, NULL), SFDAE_OK);
    CHECK(accurate(t, x, 1e-6) && on_constraints(t, x));
  }
  CHECK(report_contains(solver, "by Radau IIA with") && report_contains(solver, "(chosen automatically)"));
  sfdae_destroy(&solver);
  options = options_for(automatic, 1e-3);
  options.max_stages = 1;
  solver = create(&r, &options);
  start(solver, 0, 10);
  for (i = 1; i <= 3000; i++) CHECK_STATUS(sfdae_advance(solver, i / 300.0, &t, x, NULL), SFDAE_OK);
  CHECK(report_contains(solver, "by BDF (chosen automatically)") && statistics(solver).last_order <= 5);
  options.output = SFDAE_OUTPUT_INTERPOLATED;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  for (options.output = -1; options.output <= 2; options.output += 3)
    CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_ILLEGAL_ARGUMENT);
  sfdae_destroy(&solver);
}

/* ---- Limits and stops ---------------------------------------------------------------------------------------- */

static void nothing_is_evaluated_beyond_the_stop_time(void) {
  int c, direction, differences;
  for (c = 0; c < CHOICES; c++)
    for (differences = 0; differences <= 1; differences++)
      for (direction = -1; direction <= 1; direction += 2) {
        const double t0 = 1, stop = t0 + direction * 2;
        record r = everything();
        sfdae_options options = options_for(choices[c], 1e-5);
        sfdae_solver* solver;
        double t, x[N];
        int i;
        options.use_stop_time = 1, options.stop_time = stop;
        options.difference_derivatives = r.no_orders = differences;
        solver = create(&r, &options);
        start(solver, t0, stop);
        for (i = 1; i <= 7; i++) {
          const double tout = i == 7 ? stop : t0 + direction * 2.0 * i / 7;
          CHECK_STATUS(sfdae_advance(solver, tout, &t, x, NULL), SFDAE_OK);
          CHECK(t == tout && accurate(t, x, 1e-5));
        }
        CHECK(statistics(solver).t_internal == stop);
        CHECK_STATUS(sfdae_advance(solver, stop + direction, &t, x, NULL), SFDAE_ILLEGAL_ARGUMENT);
        CHECK(direction > 0 ? r.max_t <= stop : r.min_t >= stop);
        options.use_stop_time = 0; /* on, without a restart */
        CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
        CHECK_STATUS(sfdae_advance(solver, stop + direction, &t, x, NULL), SFDAE_OK);
        CHECK(t == stop + direction && accurate(t, x, 1e-5));
        sfdae_destroy(&solver);
      }
}

static void stop_time_may_be_close(void) {
  static const double spans[] = {1e-2, 1e-6, 1e-10, 1e-13};
  int k, c;
  for (c = 0; c < CHOICES; c++)
    for (k = 0; k < 4; k++) {
      record r = everything();
      sfdae_options options = options_for(choices[c], 1e-6);
      sfdae_solver* solver;
      const double stop = 1 + spans[k];
      double t, x[N];
      options.use_stop_time = 1, options.stop_time = stop;
      solver = create(&r, &options);
      start(solver, 1, stop);
      CHECK_STATUS(sfdae_advance(solver, stop, &t, x, NULL), SFDAE_OK);
      CHECK(t == stop && accurate(t, x, 1e-6) && r.max_t <= stop);
      sfdae_destroy(&solver);
    }
}

static void max_steps_interrupts(void) {
  int c;
  for (c = 0; c < CHOICES; c++) {
    record r = everything();
    sfdae_options options = options_for(choices[c], 1e-6);
    sfdae_solver* solver;
    double t = 0, x[N], before = 0;
    int status, calls = 0;
    options.max_steps = 2;
    solver = create(&r, &options);
    start(solver, 0, 10);
    while ((status = sfdae_advance(solver, 10, &t, x, NULL)) == SFDAE_MAX_STEPS) {
      CHECK(t >= before && t <= 10 && accurate(t, x, 1e-6) && on_constraints(t, x));
      CHECK(statistics(solver).steps <= 2 * ++calls);
      before = t;
      if (calls > 10000) break;
    }
    CHECK(status == SFDAE_OK && t == 10 && accurate(t, x, 1e-6) && calls >= 1);
    sfdae_destroy(&solver);
  }
}

static void monitor_sees_every_step_and_may_stop_it(void) {
  int c, direction;
  for (c = 0; c < CHOICES; c++)
    for (direction = -1; direction <= 1; direction += 2) {
      record r = everything();
      observer o = observer_with_tolerance(1e-6);
      sfdae_options options = options_for(choices[c], 1e-6);
      sfdae_solver* solver;
      double t, x[N], end[N];
      options.monitor = observe, options.monitor_user = &o;
      solver = create(&r, &options);
      start(solver, 0, 10 * direction);
      CHECK(o.calls == 0);
      CHECK_STATUS(sfdae_advance(solver, 10 * direction, &t, end, NULL), SFDAE_OK);
      CHECK(o.calls == statistics(solver).steps && o.t == statistics(solver).t_internal);
      CHECK(o.lowest >= 2 * choices[c].min_stages - 1 && o.highest <= 2 * choices[c].max_stages - 1);

      o = observer_with_tolerance(1e-6);
      o.stop_at = 2;
      start(solver, 0, 10 * direction);
      CHECK_STATUS(sfdae_advance(solver, 10 * direction, &t, x, NULL), SFDAE_STOPPED);
      CHECK(o.calls == 2 && t == o.t && accurate(t, x, 1e-6));
      CHECK_STATUS(sfdae_advance(solver, 10 * direction, &t, x, NULL), SFDAE_OK);
      CHECK(memcmp(x, end, sizeof x) == 0); /* as if it had not been stopped */
      sfdae_destroy(&solver);
    }
}

/* In every callback between start and tout: the call returns the last point and can be repeated. */
static void stop_requests_are_obeyed_at_every_callback(void) {
  int c;
  for (c = 0; c < CHOICES; c++) {
    long call, stopped = 0;
    for (call = 1; call <= 2000; call += 1 + call / 20) {
      record r = everything();
      const sfdae_options options = options_for(choices[c], 1e-4);
      sfdae_solver* solver = create(&r, &options);
      double t, x[N];
      int status;
      start(solver, 0, 4);
      r.calls = 0;
      r.stop_at = call;
      status = sfdae_advance(solver, 4, &t, x, NULL);
      if (r.calls > call) CHECK_STATUS(status, SFDAE_STOPPED);
      if (r.calls == call && status == SFDAE_OK) /* it was the last callback: the request is kept */
        CHECK_STATUS(sfdae_advance(solver, 5, &t, x, NULL), SFDAE_STOPPED);
      if (status == SFDAE_STOPPED) {
        stopped++;
        CHECK(r.calls == call && t >= 0 && accurate(t, x, 1e-4));
        CHECK_STATUS(sfdae_advance(solver, fmax(t, 4), &t, x, NULL), SFDAE_OK);
      }
      CHECK(t >= 4 && accurate(t, x, 1e-4) && on_constraints(t, x));
      sfdae_destroy(&solver);
      if (r.stop_at > r.calls) break;
    }
    CHECK(stopped > 10);
  }
}

int main(void) {
  illegal_methods_and_stages_are_refused();
  a_new_method_takes_effect_with_the_next_start();
  new_stages_take_effect_with_the_next_start();
  fixed_numbers_of_stages_have_their_orders();
  halving_the_step_shows_the_order();
  stages_are_chosen_to_suit_the_tolerance();
  every_output_is_accurate_and_consistent();
  frequent_output_hardly_changes_the_steps();
  single_steps_lead_to_tout();
  there_and_back_again();
  automatic_is_bdf_where_output_is_too_frequent();
  nothing_is_evaluated_beyond_the_stop_time();
  stop_time_may_be_close();
  max_steps_interrupts();
  monitor_sees_every_step_and_may_stop_it();
  stop_requests_are_obeyed_at_every_callback();
  return failures != 0;
}
