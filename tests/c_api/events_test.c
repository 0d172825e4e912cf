/* SPDX-License-Identifier: BSD-3-Clause
 * Events: found, not missed, not found twice, right in time and in values, whatever happens in between.
 *
 * Oscillator with a constraint that follows it (d = 2, a = 2):
 *     x1' = x2,   x2' = -x1,   0 = x3 - x1 - x2 - cos(3 t),   0 = x4 - 2 x3;   x1 = sin t, x2 = cos t for x(0) = (0,
 *     1).
 * Bouncing ball with a rod (index-2 part: x3 is the force that keeps x4 at 0):
 *     q' = v,   v' = -G,   x4' = x3,   0 = x4. */
#include "checks.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 4, MOST = 8 };
#define TOL 1e-8
#define GRAVITY 9.81

static const double pi = 3.14159265358979323846;

static int oscillator_E(double t, int order, double* E, void* user) {
  (void)t, (void)user;
  if (order == 0) E[0] = E[1 + N] = 1;
  return 0;
}
static int oscillator_A(double t, int order, double* A, void* user) {
  (void)t, (void)user;
  if (order > 0) return 0;
  A[0 + N] = 1, A[1] = -1;
  A[2] = A[2 + N] = -1, A[2 + 2 * N] = 1;
  A[3 + 2 * N] = -2, A[3 + 3 * N] = 1;
  return 0;
}
static int oscillator_f(double t, int order, double* f, void* user) {
  (void)user;
  f[2] = -pow(3, order) * cos(3 * t + order * pi / 2);
  return 0;
}
static int ball_E(double t, int order, double* E, void* user) {
  (void)t, (void)user;
  if (order == 0) E[0] = E[1 + N] = E[2 + 3 * N] = 1;
  return 0;
}
static int ball_A(double t, int order, double* A, void* user) {
  (void)t, (void)user;
  if (order == 0) A[0 + N] = A[2 + 2 * N] = A[3 + 3 * N] = 1;
  return 0;
}
static int ball_f(double t, int order, double* f, void* user) {
  (void)t, (void)user;
  if (order == 0) f[1] = -GRAVITY;
  return 0;
}
/* d = 0: x1 = sin t, x2 = x1', x3 = t, x4 = cos(40 t). */
static int algebraic_E(double t, int order, double* E, void* user) {
  (void)t, (void)user;
  if (order == 0) E[1] = 1;
  return 0;
}
static int algebraic_A(double t, int order, double* A, void* user) {
  (void)t, (void)user;
  if (order == 0) A[0] = A[1 + N] = A[2 + 2 * N] = A[3 + 3 * N] = 1;
  return 0;
}
static int algebraic_f(double t, int order, double* f, void* user) {
  (void)user;
  f[0] = -sin(t + order * pi / 2);
  f[2] = order == 0 ? -t : order == 1 ? -1 : 0;
  f[3] = -pow(40, order) * cos(40 * t + order * pi / 2);
  return 0;
}

/* What the event function does, and what it sees. */
typedef struct world {
  sfdae_solver* solver;
  int count;
  double level, nan_from, stop_at, fail_from;
  long calls;
  int (*g)(double t, const double* x, const double* xdot, double* g, void* user);
} world;

static int call_g(double t, const double* x, const double* xdot, double* g, void* user) {
  world* w = (world*)user;
  int i;
  for (i = 0; i < w->count; i++) CHECK(g[i] == 0);
  w->calls++;
  if (t > w->nan_from) g[0] = NAN;
  else if (w->g(t, x, xdot, g, user) != 0) return -1;
  if (t > w->stop_at) {
    w->stop_at = HUGE_VAL;
    sfdae_request_stop(w->solver);
  }
  return t > w->fail_from ? 7 : 0;
}

static int g_x1(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot;
  g[0] = x[0] - ((world*)user)->level;
  return 0;
}
static int g_t(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)x, (void)xdot;
  g[0] = t - ((world*)user)->level;
  return 0;
}
static int g_x3(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot;
  g[0] = x[2] - ((world*)user)->level;
  return 0;
}
static int g_x2dot(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)x;
  g[0] = xdot[1] - ((world*)user)->level;
  return 0;
}
static int g_x4(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot;
  g[0] = x[3] - ((world*)user)->level;
  return 0;
}
/* Simultaneous, opposite, nothing but rounding errors, identically zero, a time between. */
static int g_many(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)xdot, (void)user;
  g[0] = x[0];
  g[1] = -7 * x[0];
  g[2] = x[2] - x[0] - x[1] - cos(3 * t);
  g[3] = 0;
  g[4] = t - 4;
  return 0;
}

/* Defined on the solution only. */
static int g_strict(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)user, (void)xdot;
  g[0] = fabs(x[2] - x[0] - x[1] - cos(3 * t)) > 1e-13 ? sqrt(-1.0) : x[2];
  return 0;
}

static world here;

static sfdae_solver* create(sfdae_matrix_function E, sfdae_matrix_function A, sfdae_vector_function f, int method,
                            const sfdae_options* changed) {
  sfdae_linear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = N;
  problem.E = E, problem.A = A, problem.f = f;
  problem.constant_E = problem.constant_A = method == SFDAE_METHOD_AUTOMATIC;
  sfdae_options_init(&options, sizeof options);
  if (changed != NULL) options = *changed;
  options.method = method;
  options.rtol = options.atol = TOL;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  return solver;
}

static void watch(sfdae_solver* solver, int count, sfdae_event_function g, double level, const int* directions) {
  memset(&here, 0, sizeof here);
  here.solver = solver, here.count = count, here.level = level, here.g = g;
  here.nan_from = here.stop_at = here.fail_from = HUGE_VAL;
  CHECK_STATUS(sfdae_set_events(solver, count, call_g, directions, &here), SFDAE_OK);
}

static sfdae_solver* oscillator(int method, double t0, double toward) {
  sfdae_solver* solver = create(oscillator_E, oscillator_A, oscillator_f, method, NULL);
  double x[N] = {sin(t0), cos(t0), 0, 0};
  x[2] = x[0] + x[1] + cos(3 * t0), x[3] = 2 * x[2];
  CHECK_STATUS(sfdae_start(solver, t0, toward, x, NULL), SFDAE_OK);
  return solver;
}

/* The constraints of the oscillator hold to rounding. */
static void check_constraints(double t, const double* x) {
  CHECK(fabs(x[2] - x[0] - x[1] - cos(3 * t)) <= 40 * DBL_EPSILON);
  CHECK(fabs(x[3] - 2 * x[2]) <= 40 * DBL_EPSILON);
}

#define FOR_METHODS(method) for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_AUTOMATIC; method++)

/* ---- In time and in values ------------------------------------------------------------------------------------- */

static void zeros_of_an_oscillation(void) {
  int method, backward, k;
  FOR_METHODS(method) for (backward = 0; backward <= 1; backward++) {
    const double sign = backward ? -1 : 1, end = sign * 20;
    sfdae_solver* solver = oscillator(method, sign * 0.5, end);
    double t = 0, x[N], xdot[N];
    int which = 5;
    watch(solver, 1, g_x1, 0, NULL);
    CHECK_STATUS(sfdae_get_events(solver, &which), SFDAE_OK);
    CHECK(which == 0);
    for (k = 1; k * pi < 20; k++) {
      CHECK_STATUS(sfdae_advance(solver, end, &t, x, xdot), SFDAE_EVENT);
      CHECK(fabs(t - sign * k * pi) <= 300 * TOL);
      CHECK(fabs(x[0]) <= 8 * DBL_EPSILON * fabs(t) && fabs(xdot[0] - x[1]) <= 300 * TOL);
      CHECK(x[0] * sign * (k % 2 ? -1 : 1) >= 0); /* behind the crossing: sin falls at odd k going forward */
      check_constraints(t, x);
      CHECK_STATUS(sfdae_get_events(solver, &which), SFDAE_OK);
      CHECK(which == (backward ? -1 : 1) * (k % 2 ? -1 : 1));
    }
    CHECK_STATUS(sfdae_advance(solver, end, &t, x, NULL), SFDAE_OK);
    CHECK(t == end && fabs(x[0] - sin(end)) <= 300 * TOL);
    CHECK_STATUS(sfdae_get_events(solver, &which), SFDAE_OK);
    CHECK(which == 0);
    sfdae_destroy(&solver);
  }
}

static void times_are_exact(void) {
  static const double levels[] = {0.3, 1e-3, 7.7, 10, 1e-9};
  int method, i, one_step;
  FOR_METHODS(method) for (i = 0; i < 5; i++) for (one_step = 0; one_step <= 1; one_step++) {
    sfdae_solver* solver = oscillator(method, 0, 10);
    double t = 0, x[N];
    int status = SFDAE_STEP_TAKEN;
    watch(solver, 1, g_t, levels[i], NULL);
    if (one_step)
      while (status == SFDAE_STEP_TAKEN) status = sfdae_step(solver, 10, &t, x, NULL);
    else status = sfdae_advance(solver, 10, &t, x, NULL);
    CHECK(status == SFDAE_EVENT);
    CHECK(t >= levels[i] && t <= levels[i] * (1 + 4 * DBL_EPSILON));
    check_constraints(t, x);
    CHECK(fabs(x[0] - sin(t)) <= 300 * TOL);
    CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
    CHECK(t == 10);
    sfdae_destroy(&solver);
  }
}

/* Events on algebraic components and on slopes: what is returned, not what is interpolated, is zero. */
static void algebraic_components_and_slopes(void) {
  int method;
  FOR_METHODS(method) {
    sfdae_solver* solver = oscillator(method, 0, 10);
    double t = 0, x[N], xdot[N], last = 0;
    int count = 0, status;
    watch(solver, 1, g_x3, 0.4, NULL);
    while ((status = sfdae_advance(solver, 10, &t, x, xdot)) == SFDAE_EVENT && count < 100) {
      CHECK(fabs(x[2] - 0.4) <= 100 * DBL_EPSILON && t > last);
      CHECK(fabs(sin(t) + cos(t) + cos(3 * t) - 0.4) <= 3000 * TOL);
      check_constraints(t, x);
      last = t, count++;
    }
    CHECK(status == SFDAE_OK);
    { /* as many as the exact solution has */
      int exact = 0, k;
      double old = 2 - 0.4, now;
      for (k = 1; k <= 100000; k++, old = now) {
        const double s = k * 1e-4;
        now = sin(s) + cos(s) + cos(3 * s) - 0.4;
        exact += old * now < 0;
      }
      CHECK(count == exact);
    }
    sfdae_destroy(&solver);

    solver = oscillator(method, 0, 3);
    watch(solver, 1, g_x2dot, -0.5, NULL); /* x2' = -sin t */
    CHECK_STATUS(sfdae_advance(solver, 3, &t, x, xdot), SFDAE_EVENT);
    CHECK(fabs(t - pi / 6) <= 1e-5 && fabs(xdot[1] + 0.5) <= 1e-12);
    CHECK_STATUS(sfdae_advance(solver, 3, &t, x, xdot), SFDAE_EVENT);
    CHECK(fabs(t - 5 * pi / 6) <= 1e-5 && fabs(xdot[1] + 0.5) <= 1e-12);
    CHECK_STATUS(sfdae_advance(solver, 3, &t, x, xdot), SFDAE_OK);
    sfdae_destroy(&solver);
  }
}

/* ---- Which and how often --------------------------------------------------------------------------------------- */

static void directions_are_filtered(void) {
  int method, direction, k;
  FOR_METHODS(method) for (direction = -1; direction <= 1; direction += 2) {
    sfdae_solver* solver = oscillator(method, 0.5, 30);
    double t = 0, x[N];
    int which = 0;
    watch(solver, 1, g_x1, 0, &direction);
    for (k = direction < 0 ? 1 : 2; k * pi < 30; k += 2) {
      CHECK_STATUS(sfdae_advance(solver, 30, &t, x, NULL), SFDAE_EVENT);
      CHECK_STATUS(sfdae_get_events(solver, &which), SFDAE_OK);
      CHECK(which == direction && fabs(t - k * pi) <= 500 * TOL);
    }
    CHECK_STATUS(sfdae_advance(solver, 30, &t, x, NULL), SFDAE_OK);
    sfdae_destroy(&solver);
  }
}

static void simultaneous_events_and_silent_functions(void) {
  int method;
  FOR_METHODS(method) {
    sfdae_solver* solver = oscillator(method, 0, 7);
    double t = 0, x[N];
    int which[5];
    const int first[5] = {-1, 1, 0, 0, 0}, second[5] = {0, 0, 0, 0, 1}, third[5] = {1, -1, 0, 0, 0};
    watch(solver, 5, g_many, 0, NULL);
    CHECK_STATUS(sfdae_advance(solver, 7, &t, x, NULL), SFDAE_EVENT); /* not the zero at the start */
    CHECK_STATUS(sfdae_get_events(solver, which), SFDAE_OK);
    CHECK(memcmp(which, first, sizeof which) == 0 && fabs(t - pi) <= 300 * TOL);
    CHECK_STATUS(sfdae_advance(solver, 7, &t, x, NULL), SFDAE_EVENT);
    CHECK_STATUS(sfdae_get_events(solver, which), SFDAE_OK);
    CHECK(memcmp(which, second, sizeof which) == 0 && t >= 4 && t <= 4 + 4e-15);
    CHECK_STATUS(sfdae_advance(solver, 7, &t, x, NULL), SFDAE_EVENT);
    CHECK_STATUS(sfdae_get_events(solver, which), SFDAE_OK);
    CHECK(memcmp(which, third, sizeof which) == 0 && fabs(t - 2 * pi) <= 300 * TOL);
    CHECK_STATUS(sfdae_advance(solver, 7, &t, x, NULL), SFDAE_OK);
    sfdae_destroy(&solver);
  }
}

/* sin t exceeds 1 - d only between pi/2 - s and pi/2 + s, cos s = 1 - d. */
static void double_zeros_within_a_step(void) {
  static const double depths[] = {0.1, 0.01, 1e-4};
  int method, i;
  FOR_METHODS(method) for (i = 0; i < 3; i++) {
    const double s = acos(1 - depths[i]);
    sfdae_solver* solver = oscillator(method, 0, 3);
    double t = 0, x[N];
    watch(solver, 1, g_x1, 1 - depths[i], NULL);
    CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_EVENT);
    CHECK(fabs(t - (pi / 2 - s)) <= 300 * TOL / s);
    CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_EVENT);
    CHECK(fabs(t - (pi / 2 + s)) <= 300 * TOL / s);
    CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_OK);
    sfdae_destroy(&solver);
  }
}

/* At tout it belongs to this call; outputs in between change nothing; the point of an event can be reached again. */
static void events_and_outputs(void) {
  int method, k;
  FOR_METHODS(method) {
    sfdae_solver* solver = oscillator(method, 0, 10);
    double t = 0, x[N], y[N], ydot[N], at;
    int which, events = 0;
    watch(solver, 1, g_t, 2, NULL);
    CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_EVENT);
    CHECK(t == 2);
    CHECK_STATUS(sfdae_get_events(solver, &which), SFDAE_OK);
    CHECK(which == 1);
    CHECK_STATUS(sfdae_advance(solver, 2, &t, y, NULL), SFDAE_OK);
    CHECK(t == 2 && memcmp(x, y, sizeof x) == 0);
    CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
    sfdae_destroy(&solver);

    solver = oscillator(method, 0, 10);
    watch(solver, 1, g_x1, 0, NULL);
    for (k = 1; k <= 1000; k++) {
      int status;
      while ((status = sfdae_advance(solver, k * 0.01, &t, x, NULL)) == SFDAE_EVENT) {
        events++;
        CHECK(fabs(t - events * pi) <= 300 * TOL && t > (k - 1) * 0.01 && t <= k * 0.01);
        if (events == 2) {
          sfdae_statistics s;
          sfdae_statistics_init(&s, sizeof s);
          CHECK_STATUS(sfdae_get_statistics(solver, &s), SFDAE_OK);
          for (at = 0; at <= 1; at += 0.125) {
            const double u = s.t_internal - at * s.last_step;
            CHECK_STATUS(sfdae_interpolate(solver, u, y, ydot), SFDAE_OK);
            CHECK(fabs(y[0] - sin(u)) <= 300 * TOL && fabs(ydot[1] + sin(u)) <= 1e-4);
            check_constraints(u, y);
          }
          CHECK_STATUS(sfdae_interpolate(solver, s.t_internal - 1.01 * s.last_step, y, NULL), SFDAE_ILLEGAL_ARGUMENT);
          CHECK_STATUS(sfdae_interpolate(solver, s.t_internal + 0.01 * s.last_step, y, NULL), SFDAE_ILLEGAL_ARGUMENT);
          CHECK_STATUS(sfdae_interpolate(solver, NAN, y, NULL), SFDAE_ILLEGAL_ARGUMENT);
          CHECK_STATUS(sfdae_interpolate(solver, t, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
          CHECK_STATUS(sfdae_interpolate(solver, t, y, NULL), SFDAE_OK);
          CHECK(fabs(y[0]) <= 1e-9);
        }
      }
      CHECK(status == SFDAE_OK && t == k * 0.01 && fabs(x[0] - sin(t)) <= 300 * TOL);
    }
    CHECK(events == 3);
    sfdae_destroy(&solver);
  }
}

static void events_at_the_stop_time(void) {
  int method;
  FOR_METHODS(method) {
    sfdae_options options;
    sfdae_solver* solver;
    double t = 0, x[N] = {0, 1, 2, 4};
    sfdae_options_init(&options, sizeof options);
    options.use_stop_time = 1, options.stop_time = 3;
    solver = create(oscillator_E, oscillator_A, oscillator_f, method, &options);
    watch(solver, 1, g_t, 3, NULL);
    CHECK_STATUS(sfdae_start(solver, 0, 3, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_EVENT);
    CHECK(t == 3);
    CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_OK);
    sfdae_destroy(&solver);
  }
}

/* Functions that cannot be evaluated where constraints are violated. */
static void functions_defined_on_the_solution_only(void) {
  int method;
  FOR_METHODS(method) {
    sfdae_solver* solver = oscillator(method, 0, 10);
    double t = 0, x[N];
    int events = 0, status;
    watch(solver, 1, g_strict, 0, NULL);
    while ((status = sfdae_advance(solver, 10, &t, x, NULL)) == SFDAE_EVENT && events++ < 100)
      CHECK(fabs(x[2]) <= 100 * DBL_EPSILON && fabs(sin(t) + cos(t) + cos(3 * t)) <= 3000 * TOL);
    CHECK(status == SFDAE_OK);
    { /* as many as the exact solution has */
      int exact = 0, k;
      double old = 2, now;
      for (k = 1; k <= 100000; k++, old = now) {
        const double s = k * 1e-4;
        now = sin(s) + cos(s) + cos(3 * s);
        exact += old * now < 0;
      }
      CHECK(events == exact && exact > 0);
    }
    sfdae_destroy(&solver);
  }
}

/* Outputs in clusters make steps of very different sizes, and x3 varies faster than they show. */
static void clustered_outputs_hide_nothing(void) {
  int method, run;
  FOR_METHODS(method) for (run = 0; run < 40; run++) {
    const double level = -0.8 + 0.04 * run;
    sfdae_solver* solver = oscillator(method, 0, 20);
    double t = 0, x[N], tout = 0, old = 2 - level, now;
    int k, exact = 0, events = 0, status;
    watch(solver, 1, g_x3, level, NULL);
    for (k = 1; tout < 20; k++) {
      tout = fmin(20, tout + pow(10, -1.5 + 1.5 * sin(k * k + run))); /* 0.001 ... 1 */
      while ((status = sfdae_advance(solver, tout, &t, x, NULL)) == SFDAE_EVENT && events++ < 100)
        CHECK(fabs(x[2] - level) <= 1e-13);
      CHECK(status == SFDAE_OK);
    }
    for (k = 1; k <= 200000; k++, old = now) {
      const double s = k * 1e-4;
      now = sin(s) + cos(s) + cos(3 * s) - level;
      exact += old * now < 0;
    }
    CHECK(events == exact);
    sfdae_destroy(&solver);
  }
}

/* ---- Restarts -------------------------------------------------------------------------------------------------- */

/* From height 1 at rest: impacts at T, T + 2 r T, T + 2 (r + r^2) T, ..., T = sqrt(2 / G), each with r times the
 * speed. */
static void bouncing_ball(void) {
  int method, backward, direction, k;
  FOR_METHODS(method)
  for (backward = 0; backward <= 1; backward++)
    for (direction = -1; direction <= 0; direction++) {
      const double sign = backward ? -1 : 1, r = 0.8, T = sqrt(2 / GRAVITY), end = sign * 10;
      sfdae_solver* solver = create(ball_E, ball_A, ball_f, method, NULL);
      double t = 0, x[N] = {1, 0, 0, 0}, impact = T, flight = T;
      watch(solver, 1, g_x1, 0, &direction);
      CHECK_STATUS(sfdae_start(solver, 0, end, x, NULL), SFDAE_OK);
      for (k = 1; k <= 25; k++) {
        CHECK_STATUS(sfdae_advance(solver, end, &t, x, NULL), SFDAE_EVENT);
        CHECK(fabs(t - sign * impact) <= 200 * TOL * k);
        CHECK(fabs(x[0]) <= 1e-14 && fabs(x[2]) <= 1e-14 && fabs(x[3]) <= 1e-14);
        CHECK(fabs(x[1] + sign * GRAVITY * T * pow(r, k - 1)) <= 1000 * TOL * k);
        x[1] = -r * x[1];
        flight *= r;
        impact += 2 * flight;
        CHECK_STATUS(sfdae_start(solver, t, end, x, NULL), SFDAE_OK);
      }
      sfdae_destroy(&solver);
    }
}

/* A restart at the point of an event without any change does not see it again; nor does a start on a zero. */
static void restarts_do_not_repeat_events(void) {
  int method, k, round;
  FOR_METHODS(method) {
    sfdae_solver* solver = oscillator(method, 0, 20);
    double t = 0, x[N];
    watch(solver, 1, g_x1, 0, NULL);
    for (k = 1; k <= 5; k++) {
      CHECK_STATUS(sfdae_advance(solver, 20, &t, x, NULL), SFDAE_EVENT);
      CHECK(fabs(t - k * pi) <= 1000 * TOL);
      for (round = 0; round < k; round++) CHECK_STATUS(sfdae_start(solver, t, 20, x, NULL), SFDAE_OK);
    }
    for (k = 5; k >= 2; k--) { /* and back, from the same zero */
      CHECK_STATUS(sfdae_start(solver, t, 0, x, NULL), SFDAE_OK);
      CHECK_STATUS(sfdae_advance(solver, 0, &t, x, NULL), SFDAE_EVENT);
      CHECK(fabs(t - (k - 1) * pi) <= 1000 * TOL);
    }
    sfdae_destroy(&solver);
  }
}

/* ---- Trouble ---------------------------------------------------------------------------------------------------- */

static void failures_of_the_event_function(void) {
  int method, kind;
  FOR_METHODS(method) for (kind = 0; kind < 3; kind++) {
    static const int expected[] = {SFDAE_NOT_FINITE, SFDAE_CALLBACK_FAILED, SFDAE_STOPPED};
    sfdae_solver* solver = oscillator(method, 0, 10);
    double t = -1, x[N] = {9, 9, 9, 9};
    watch(solver, 1, g_x1, 0.5, NULL);
    if (kind == 0) here.nan_from = 2;
    if (kind == 1) here.fail_from = 2;
    if (kind == 2) here.stop_at = 2;
    CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_EVENT);
    CHECK(fabs(t - pi / 6) <= 300 * TOL);
    CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), expected[kind]);
    CHECK(sfdae_message(solver)[0] != 0);
    CHECK(t >= pi / 6 && t <= 2 && fabs(x[0] - sin(t)) <= 300 * TOL); /* searched up to here */
    check_constraints(t, x);
    here.nan_from = here.fail_from = HUGE_VAL;
    CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_EVENT);
    CHECK(fabs(t - 5 * pi / 6) <= 300 * TOL);
    sfdae_destroy(&solver);
  }
  FOR_METHODS(method) { /* at the start */
    sfdae_solver* solver = oscillator(method, 0, 10);
    double t = -1, x[N];
    watch(solver, 1, g_x1, 0.5, NULL);
    here.nan_from = -1;
    CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_NOT_FINITE);
    CHECK(t == 0 && x[1] == 1);
    here.nan_from = HUGE_VAL;
    CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_EVENT);
    CHECK(fabs(t - pi / 6) <= 300 * TOL);
    sfdae_destroy(&solver);
  }
}

static int stop_always(const sfdae_progress* progress, void* user) {
  (void)progress, (void)user;
  return 1;
}

/* Points returned never lie beyond events that have not been told. */
static void calls_that_end_early(void) {
  int method, kind;
  FOR_METHODS(method) for (kind = 0; kind < 2; kind++) {
    sfdae_options options;
    sfdae_solver* solver;
    double t = 0, x[N] = {0, 1, 2, 4}, last = 0;
    int events = 0, status, calls = 0;
    sfdae_options_init(&options, sizeof options);
    if (kind == 0) options.monitor = stop_always;
    else options.max_steps = 1;
    solver = create(oscillator_E, oscillator_A, oscillator_f, method, &options);
    watch(solver, 1, g_x1, 0, NULL);
    CHECK_STATUS(sfdae_start(solver, 0, 10, x, NULL), SFDAE_OK);
    while ((status = sfdae_advance(solver, 10, &t, x, NULL)) != SFDAE_OK && calls++ < 10000) {
      CHECK(status == SFDAE_EVENT || status == (kind == 0 ? SFDAE_STOPPED : SFDAE_MAX_STEPS));
      CHECK(t >= last && t <= 10 && fabs(x[0] - sin(t)) <= 300 * TOL);
      check_constraints(t, x);
      last = t;
      if (status == SFDAE_EVENT) CHECK(fabs(t - ++events * pi) <= 300 * TOL);
    }
    CHECK(status == SFDAE_OK && events == 3);
    sfdae_destroy(&solver);
  }
}

/* ---- Without dynamics ------------------------------------------------------------------------------------------- */

static void problems_without_dynamics(void) {
  int method, k;
  FOR_METHODS(method) {
    sfdae_solver* solver = create(algebraic_E, algebraic_A, algebraic_f, method, NULL);
    double t = 0, x[N] = {0, 1, 0, 1};
    int status, events = 0;
    watch(solver, 1, g_x1, 0, NULL);
    CHECK_STATUS(sfdae_start(solver, 0, 100, x, NULL), SFDAE_OK);
    for (k = 1; k * pi < 100; k++) { /* 32 zeros in a single step, were it for the problem */
      CHECK_STATUS(sfdae_advance(solver, 100, &t, x, NULL), SFDAE_EVENT);
      CHECK(fabs(t - k * pi) <= 4 * DBL_EPSILON * t + 1e-15);
      CHECK(fabs(x[1] - cos(t)) <= 1e-12);
    }
    CHECK_STATUS(sfdae_advance(solver, 100, &t, x, NULL), SFDAE_OK);
    watch(solver, 1, g_x4, 0.2, NULL);
    x[0] = 0, x[1] = 1, x[2] = 0, x[3] = 1;
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
    while ((status = sfdae_advance(solver, 1, &t, x, NULL)) == SFDAE_EVENT && events < 100) {
      CHECK(fabs(x[3] - 0.2) <= 1e-13 && fabs(cos(40 * t) - 0.2) <= 1e-13);
      events++;
    }
    CHECK(status == SFDAE_OK && events == 13); /* 40 t = acos(0.2) + 2 k pi, 2 k pi - acos(0.2) */
    sfdae_destroy(&solver);
  }
}

/* ---- Checkpoints ------------------------------------------------------------------------------------------------ */

static void checkpoints_contain_the_signs(void) {
  int method;
  FOR_METHODS(method) {
    sfdae_solver *plain = oscillator(method, 0, 10), *broken = oscillator(method, 0, 10);
    double t = 0, u = 0, x[N], y[N], xdot[N], ydot[N], tout = 0;
    int calls = 0, status, events = 0, which[5], which_broken[5];
    size_t length;
    double* values;
    watch(plain, 5, g_many, 0, NULL);
    watch(broken, 5, g_many, 0, NULL);
    while (t < 10 && calls < 1000) {
      CHECK_STATUS(sfdae_get_checkpoint_length(broken, &length), SFDAE_OK);
      values = (double*)malloc(length * sizeof *values);
      CHECK_STATUS(sfdae_save_checkpoint(broken, values, length), SFDAE_OK);
      sfdae_destroy(&broken);
      broken = create(oscillator_E, oscillator_A, oscillator_f, method, NULL);
      if (calls == 3) CHECK_STATUS(sfdae_restore_checkpoint(broken, values, length), SFDAE_ILLEGAL_ARGUMENT);
      if (calls == 3) {
        watch(broken, 1, g_x1, 0, NULL);
        CHECK_STATUS(sfdae_restore_checkpoint(broken, values, length), SFDAE_ILLEGAL_ARGUMENT);
      }
      watch(broken, 5, g_many, 0, NULL);
      CHECK_STATUS(sfdae_restore_checkpoint(broken, values, length), SFDAE_OK);
      free(values);
      if (t >= tout) tout = fmin(10, t + 0.7);
      calls++;
      if (calls % 3 == 0) {
        status = sfdae_step(plain, tout, &t, x, xdot);
        CHECK_STATUS(sfdae_step(broken, tout, &u, y, ydot), status);
      } else {
        status = sfdae_advance(plain, tout, &t, x, xdot);
        CHECK_STATUS(sfdae_advance(broken, tout, &u, y, ydot), status);
      }
      CHECK(t == u && memcmp(x, y, sizeof x) == 0 && memcmp(xdot, ydot, sizeof xdot) == 0);
      CHECK_STATUS(sfdae_get_events(plain, which), SFDAE_OK);
      CHECK_STATUS(sfdae_get_events(broken, which_broken), SFDAE_OK);
      CHECK(memcmp(which, which_broken, sizeof which) == 0);
      events += status == SFDAE_EVENT;
    }
    CHECK(t == 10 && events == 4); /* pi, 4, 2 pi, 3 pi */
    sfdae_destroy(&plain);
    sfdae_destroy(&broken);
  }
}

/* ---- Arguments -------------------------------------------------------------------------------------------------- */

static int g_busy(double t, const double* x, const double* xdot, double* g, void* user) {
  int which = 3;
  double y[N];
  world* w = (world*)user;
  CHECK_STATUS(sfdae_set_events(w->solver, 0, NULL, NULL, NULL), SFDAE_BUSY);
  CHECK_STATUS(sfdae_interpolate(w->solver, t, y, NULL), SFDAE_BUSY);
  CHECK_STATUS(sfdae_get_events(w->solver, &which), SFDAE_OK);
  return g_x1(t, x, xdot, g, user);
}

static void arguments_and_changes(void) {
  const int wrong[2] = {1, 2};
  double t = 0, x[N] = {0, 1, 2, 4};
  int which = 9;
  sfdae_options options;
  sfdae_solver* solver = create(oscillator_E, oscillator_A, oscillator_f, SFDAE_METHOD_RADAU, NULL);
  CHECK_STATUS(sfdae_set_events(NULL, 1, call_g, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_events(solver, -1, call_g, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_events(solver, 1, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_events(solver, 2, call_g, wrong, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(sfdae_message(solver)[0] != 0);
  CHECK_STATUS(sfdae_get_events(NULL, &which), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_events(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_events(solver, &which), SFDAE_OK);
  CHECK(which == 9); /* none are set */
  CHECK_STATUS(sfdae_interpolate(solver, 0, x, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_interpolate(NULL, 0, x, NULL), SFDAE_ILLEGAL_ARGUMENT);

  watch(solver, 1, g_busy, 0.5, NULL);
  CHECK_STATUS(sfdae_analyze(solver, 0, 10, NULL), SFDAE_OK); /* events survive */
  CHECK_STATUS(sfdae_start(solver, 0, 10, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_interpolate(solver, 0, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_EVENT);
  CHECK(fabs(t - pi / 6) <= 300 * TOL);
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = TOL, options.method = SFDAE_METHOD_RADAU;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_EVENT);
  CHECK(fabs(t - 5 * pi / 6) <= 300 * TOL);
  /* New ones count from here on, be it amid a step. */
  watch(solver, 1, g_x1, 0.25, NULL);
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_EVENT);
  CHECK(fabs(t - (pi - asin(0.25))) <= 300 * TOL);
  CHECK_STATUS(sfdae_set_events(solver, 0, NULL, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
  CHECK(t == 10 && fabs(x[0] - sin(10)) <= 300 * TOL);
  sfdae_destroy(&solver);
}

int main(void) {
  zeros_of_an_oscillation();
  times_are_exact();
  algebraic_components_and_slopes();
  directions_are_filtered();
  simultaneous_events_and_silent_functions();
  double_zeros_within_a_step();
  events_and_outputs();
  events_at_the_stop_time();
  functions_defined_on_the_solution_only();
  clustered_outputs_hide_nothing();
  bouncing_ball();
  restarts_do_not_repeat_events();
  failures_of_the_event_function();
  calls_that_end_early();
  problems_without_dynamics();
  checkpoints_contain_the_signs();
  arguments_and_changes();
  return failures != 0;
}
