/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Callbacks that fail, return NaN, use the solver or stop it, at every single call in every phase. The status is
 * the documented one and the solver works again once the fault is gone. Small: at every call one in four faults.
 *
 *     s x1' = s x2,   x2' = x5 - x1 - cos t,   x3' = x4,   0 = x3 - x1 - sin 2t,   s = 2 + sin t
 * mu = 1, d = 2, a = 2, u = 1; x5 is prescribed as cos t.
 *     x = (cos t, -sin t, cos t + sin 2t, -sin t + 2 cos 2t, cos t)
 */
#define _POSIX_C_SOURCE 200809L
#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <sfdae/sfdae.h>

#include "checks.h"

/* ---- The problem and what goes wrong in it ------------------------------------------------------ */

enum kind { POSITIVE, LARGEST, NEGATIVE, SMALLEST, NOT_A_NUMBER, INFINITE, NO_ORDER, STOP, KINDS };
static const char* const kind_names[KINDS] = {"1",   "INT_MAX", "-7",       "INT_MIN",
                                              "NaN", "Inf",     "no order", "request_stop"};

typedef struct {
  sfdae_solver* solver;
  char function; /* 'E', 'A', 'f', 'p' (prescribed values), 'm' (monitor) or 0: none goes wrong */
  enum kind kind;
  long call; /* the call that goes wrong, counted from 1; 0: those at t > after */
  double after;
  int no_orders; /* 1: only order 0 can be provided */
  long calls;    /* of the function that goes wrong */
  int order;     /* asked for in the call that went wrong */
  int highest_order;
  int inside; /* in the callback: what to do with the solver */
} plan;

#define TOL 1e-4
static int method = SFDAE_METHOD_BDF; /* of all solvers */
enum { M = 4, N = 5 };

static void use_solver_from_inside(sfdae_solver* solver);

static void expect_zeros(const double* values, int count) {
  int i;
  for (i = 0; i < count; i++) CHECK(values[i] == 0);
}

/* Returns what the callback shall return; spoils its values if that is the fault. */
static int fault(plan* p, char function, double t, int order, double* values) {
  int strikes;
  if (order > p->highest_order) p->highest_order = order;
  if (p->inside && function == p->function) use_solver_from_inside(p->solver);
  if (p->no_orders && order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
  if (function != p->function) return 0;
  p->calls++;
  strikes = p->call ? p->calls == p->call : t > p->after;
  if (!strikes) return 0;
  p->order = order;
  switch (p->kind) {
    case POSITIVE: return 1;
    case LARGEST: return INT_MAX;
    case NEGATIVE: return -7;
    case SMALLEST: return INT_MIN;
    case NOT_A_NUMBER: values[0] = NAN; return 0;
    case INFINITE: values[0] = -INFINITY; return 0;
    case NO_ORDER: return SFDAE_ORDER_NOT_AVAILABLE;
    case STOP: CHECK(sfdae_request_stop(p->solver) == SFDAE_OK); return 0;
    default: return 0;
  }
}

/* The derivative of s = 2 + sin t, and that of sin(w t). */
static double s(double t, int order) { return (order == 0 ? 2 : 0) + sin(t + order * acos(0.0)); }
static double sine(double w, double t, int order) { return pow(w, order) * sin(w * t + order * acos(0.0)); }

static int E(double t, int order, double* matrix, void* user) {
  expect_zeros(matrix, M * N);
  matrix[0] = s(t, order);
  if (order == 0) matrix[5] = matrix[10] = 1;
  return fault((plan*)user, 'E', t, order, matrix);
}

static int A(double t, int order, double* matrix, void* user) {
  expect_zeros(matrix, M * N);
  matrix[0 + 4 * 1] = s(t, order);
  if (order == 0) {
    matrix[1 + 4 * 0] = -1;
    matrix[2 + 4 * 3] = 1;
    matrix[3 + 4 * 0] = -1;
    matrix[3 + 4 * 2] = 1;
    matrix[1 + 4 * 4] = 1;
  }
  return fault((plan*)user, 'A', t, order, matrix);
}

static int f(double t, int order, double* vector, void* user) {
  expect_zeros(vector, 4);
  vector[1] = -sine(1, t, order + 1);
  vector[3] = -sine(2, t, order);
  return fault((plan*)user, 'f', t, order, vector);
}

static int prescribed(double t, int order, double* values, void* user) {
  CHECK(values[0] == 0 && order == 0);
  values[0] = cos(t);
  return fault((plan*)user, 'p', t, order, values);
}

static int monitor(const sfdae_progress* progress, void* user) {
  plan* p = (plan*)user;
  double spoiled[1];
  if (p->function != 'm') return 0;
  if (p->inside) use_solver_from_inside(p->solver);
  return fault(p, 'm', progress->t, 0, spoiled);
}

static void exact(double t, double* x) {
  x[0] = cos(t);
  x[1] = -sin(t);
  x[2] = cos(t) + sin(2 * t);
  x[3] = -sin(t) + 2 * cos(2 * t);
  x[4] = cos(t);
}

/* The error stays below 10 times the tolerance. */
static int accurate(double t, const double* x) {
  double xe[N];
  int i;
  exact(t, xe);
  for (i = 0; i < N; i++)
    if (!(fabs(x[i] - xe[i]) <= 10 * (TOL * fabs(xe[i]) + TOL))) return 0;
  return 1;
}

static sfdae_options loose_options(plan* p) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = TOL;
  options.method = method;
  options.monitor = monitor;
  options.monitor_user = p;
  return options;
}

static sfdae_linear_problem problem_with(plan* p) {
  static const int last[1] = {N - 1};
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = M;
  problem.num_unknowns = N;
  problem.E = E;
  problem.A = A;
  problem.f = f;
  problem.num_prescribed = 1;
  problem.prescribed = last;
  problem.prescribed_values = prescribed;
  problem.user = p;
  return problem;
}

static sfdae_solver* create(plan* p) {
  sfdae_options options = loose_options(p);
  sfdae_linear_problem problem = problem_with(p);
  sfdae_solver* solver = NULL;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  p->solver = solver;
  return solver;
}

static plan no_fault(void) {
  plan p;
  memset(&p, 0, sizeof p);
  return p;
}

static void works(sfdae_solver* solver) {
  double t = -1, x[N];
  exact(0, x);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(t == 1 && accurate(t, x));
  CHECK(strcmp(sfdae_message(solver), "") == 0);
}

/* ---- Phases: one call each, with what it promises about its outputs ------------------------------- */

static const double unset = -12345.678; /* outputs that nobody has written */

static int run_analyze(sfdae_solver* solver) {
  sfdae_characteristics c, before;
  int status;
  sfdae_characteristics_init(&c, sizeof c);
  before = c;
  status = sfdae_analyze(solver, 0, 1, &c);
  if (status == SFDAE_OK) CHECK(c.strangeness_index == 1 && c.differential == 2 && c.algebraic == 2);
  else CHECK(memcmp(&c, &before, sizeof c) == 0);
  return status;
}

static int initial(sfdae_solver* solver, int start) {
  double x[N], before[N], xdot[N] = {unset, unset, unset, unset, unset};
  int status;
  exact(0, x);
  memcpy(before, x, sizeof x);
  x[3] = before[3] = 0.5;
  status = start ? sfdae_start(solver, 0, 1, x, xdot) : sfdae_make_consistent(solver, 0, x, xdot);
  if (status == SFDAE_OK) CHECK(xdot[0] != unset && fabs(x[3] - x[1] - 2) <= 1e-12);
  else CHECK(memcmp(x, before, sizeof x) == 0 && xdot[0] == unset && xdot[3] == unset);
  return status;
}
static int run_start(sfdae_solver* solver) { return initial(solver, 1); }
static int run_make_consistent(sfdae_solver* solver) { return initial(solver, 0); }

/* Whatever happens on the way, the last accepted point is returned; the last step may have gone past tout = 1. */
static const double farthest = 2;
static int run_advance(sfdae_solver* solver) {
  double t = unset, x[N] = {unset, unset, unset, unset, unset}, xdot[N];
  const int status = sfdae_advance(solver, 1, &t, x, xdot);
  CHECK(t >= 0 && t <= farthest && accurate(t, x));
  CHECK(status != SFDAE_OK || t == 1);
  return status;
}

static int run_steps(sfdae_solver* solver) {
  double t = unset, x[N] = {unset, unset, unset, unset, unset}, before = 0;
  int status;
  do {
    status = sfdae_step(solver, 1, &t, x, NULL);
    CHECK(t >= before && t <= farthest && accurate(t, x));
    before = t;
  } while (status == SFDAE_STEP_TAKEN);
  return status;
}

static int run_derivative_array(sfdae_solver* solver) {
  double array[80], right[40], g[8];
  int status;
  array[0] = right[0] = g[0] = unset;
  status = sfdae_get_derivative_array(solver, 0.5, 1, array, right, g);
  CHECK((status == SFDAE_OK) == (array[0] != unset) && (status == SFDAE_OK) == (right[0] != unset));
  CHECK((status == SFDAE_OK) == (g[0] != unset));
  return status;
}

static int run_projectors(sfdae_solver* solver) {
  double Z1[8], Z2[16], T2[15];
  int status, vhat = -1;
  Z1[0] = Z2[0] = T2[0] = unset;
  status = sfdae_get_projectors(solver, 0.5, Z1, Z2, NULL, T2, &vhat);
  CHECK((status == SFDAE_OK) == (Z1[0] != unset) && (status == SFDAE_OK) == (Z2[0] != unset));
  CHECK((status == SFDAE_OK) == (T2[0] != unset) && (status == SFDAE_OK) == (vhat == 0));
  return status;
}

static int run_strangeness_free(sfdae_solver* solver) {
  double E1[10], A1[10], f1[2], A2[10], f2[2], residual = unset;
  int status;
  E1[0] = A2[0] = unset;
  status = sfdae_get_strangeness_free(solver, 0.5, E1, A1, f1, A2, f2, &residual);
  CHECK((status == SFDAE_OK) == (E1[0] != unset) && (status == SFDAE_OK) == (A2[0] != unset));
  CHECK((status == SFDAE_OK) == (residual != unset));
  return status;
}

static int run_check_derivatives(sfdae_solver* solver) {
  sfdae_derivative_check check;
  sfdae_derivative_check_init(&check, sizeof check);
  return sfdae_check_derivatives(solver, 0.5, 2, &check);
}

enum preparation { NOTHING, ANALYZED, STARTED };
static const struct phase {
  const char* name;
  int (*run)(sfdae_solver*);
  enum preparation before;
  int integrates; /* a smaller step may help */
} phases[] = {
    {"analyze", run_analyze, NOTHING, 0},
    {"make_consistent", run_make_consistent, NOTHING, 0},
    {"start", run_start, NOTHING, 0},
    {"start, analyzed", run_start, ANALYZED, 0},
    {"advance", run_advance, STARTED, 1},
    {"step", run_steps, STARTED, 1},
    {"derivative array", run_derivative_array, ANALYZED, 0},
    {"projectors", run_projectors, ANALYZED, 0},
    {"strangeness-free", run_strangeness_free, ANALYZED, 0},
    {"check derivatives", run_check_derivatives, NOTHING, 0},
};
enum { PHASES = sizeof phases / sizeof phases[0] };

static void prepare(sfdae_solver* solver, enum preparation before) {
  double x[N];
  exact(0, x);
  if (before == ANALYZED) CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_OK);
  if (before == STARTED) CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
}

/* ---- Every call fails once ------------------------------------------------------------------------ */

/* `spared`: the library may find a way around the fault, by a smaller step, another point or differences. */
static int documented(enum kind kind, int order, int status, int spared) {
  switch (kind) {
    case POSITIVE:
    case LARGEST: return status == SFDAE_CALLBACK_FAILED || (spared && status == SFDAE_OK);
    case NEGATIVE:
    case SMALLEST: return status == SFDAE_CALLBACK_STOPPED;
    case NOT_A_NUMBER:
    case INFINITE: return status == SFDAE_NOT_FINITE || (spared && status == SFDAE_OK);
    case NO_ORDER:
      return status == SFDAE_ORDER_MISSING || (order == 0 && status == SFDAE_CALLBACK_FAILED) ||
             (spared && status == SFDAE_OK);
    case STOP: return status == SFDAE_STOPPED || status == SFDAE_OK; /* OK: it was the last callback */
    default: return 0;
  }
}

/* Lets the call number `call` go wrong; 0 if there was no such call. */
static int call_goes_wrong(const struct phase* phase, char function, enum kind kind, long call) {
  plan p = no_fault();
  sfdae_solver* solver = create(&p);
  const int failures_before = failures;
  int status, struck, spared;
  prepare(solver, phase->before);
  p.function = function;
  p.kind = kind;
  p.call = call;
  p.calls = 0;
  status = phase->run(solver);
  p.function = 0;
  struck = p.calls >= call;
  spared = phase->integrates || call > 1 || phase->run == run_check_derivatives;
  if (!struck) CHECK_STATUS(status, SFDAE_OK);
  if (struck && !documented(kind, p.order, status, spared)) {
    failures++;
    fprintf(stderr, "%s:%d: status %s\n", __FILE__, __LINE__, sfdae_status_name(status));
  }
  CHECK((status == SFDAE_OK) == (sfdae_message(solver)[0] == 0));
  if (struck && kind == STOP && status == SFDAE_OK) /* still to be obeyed */
    CHECK_STATUS(run_start(solver), SFDAE_STOPPED);
  if (struck && kind == NO_ORDER) { /* which may be remembered: nothing more is to be expected of this solver */
    sfdae_destroy(&solver);
    return struck;
  }
  if (phase->integrates && status != SFDAE_OK) CHECK_STATUS(run_advance(solver), SFDAE_OK);
  works(solver);
  sfdae_destroy(&solver);
  if (failures > failures_before)
    fprintf(stderr, "  ... in %s, call %ld of %c returning %s\n", phase->name, call, function, kind_names[kind]);
  return struck;
}

static void every_call_may_go_wrong(void) {
  static const char functions[] = {'E', 'A', 'f', 'p'};
  int phase, function, kind;
  for (phase = 0; phase < PHASES; phase++)
    for (function = 0; function < 4; function++)
      for (kind = 0; kind < KINDS; kind++) {
        const int failures_before = failures;
        long call = 1 + kind % stride(4);
        while (call_goes_wrong(&phases[phase], functions[function], (enum kind)kind, call) &&
               failures < failures_before + 3)
          call += stride(4);
        CHECK(call > 1 || function >= 2); /* ranks need no f */
      }
}

static void every_monitor_call_may_stop(void) {
  long call = 1;
  for (;; call++) {
    plan p = no_fault();
    sfdae_solver* solver = create(&p);
    double t = unset, x[N];
    int status;
    prepare(solver, STARTED);
    p.function = 'm';
    p.kind = call % 2 ? POSITIVE : NEGATIVE; /* any value but 0 stops */
    p.call = call;
    status = sfdae_advance(solver, 1, &t, x, NULL);
    CHECK_STATUS(status, p.calls >= call ? SFDAE_STOPPED : SFDAE_OK);
    CHECK(t > 0 && t <= farthest && accurate(t, x));
    p.function = 0;
    CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
    CHECK(t == 1 && accurate(t, x));
    works(solver);
    sfdae_destroy(&solver);
    if (p.calls < call) break;
  }
  CHECK(call > 1);
}

/* ---- Faults that last ----------------------------------------------------------------------------- */

/* Beyond t = 0.9 nothing can be evaluated: the solver comes close from below and says why it stays there. */
static void functions_end_before_tout(void) {
  static const struct {
    enum kind kind;
    int status;
  } table[] = {{POSITIVE, SFDAE_CALLBACK_FAILED},
               {NOT_A_NUMBER, SFDAE_NOT_FINITE},
               {INFINITE, SFDAE_NOT_FINITE},
               {NEGATIVE, SFDAE_CALLBACK_STOPPED}};
  static const char functions[] = {'E', 'A', 'f', 'p'};
  int i, k;
  for (i = 0; i < 4; i++)
    for (k = 0; k < 4; k++) {
      plan p = no_fault();
      sfdae_solver* solver = create(&p);
      double t = unset, x[N];
      p.function = functions[k];
      p.kind = table[i].kind;
      p.after = 0.9;
      prepare(solver, STARTED);
      CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), table[i].status);
      CHECK(t > 0 && t <= 0.9 && accurate(t, x));
      CHECK(sfdae_message(solver)[0] != 0);
      CHECK_STATUS(sfdae_advance(solver, t, &t, x, NULL), SFDAE_OK);
      p.function = 0;
      CHECK_STATUS(sfdae_start(solver, t, 1, x, NULL), SFDAE_OK);
      CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
      CHECK(t == 1 && accurate(t, x));
      sfdae_destroy(&solver);
    }
}

static void derivatives_that_are_missing_are_named_or_differenced(void) {
  plan p = no_fault();
  sfdae_solver* solver = create(&p);
  sfdae_options options = loose_options(&p);
  double x[N];
  exact(0, x);
  p.no_orders = 1;
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_ORDER_MISSING);
  CHECK(sfdae_message(solver)[0] != 0);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_ORDER_MISSING);
  options.difference_derivatives = 1;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  works(solver);
  sfdae_destroy(&solver);
}

/* ---- Orders asked for ------------------------------------------------------------------------------- */

static void no_order_is_asked_for_that_the_header_does_not_name(void) {
  plan p = no_fault();
  sfdae_solver* solver = create(&p);
  double t, x[N];
  exact(0, x);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_OK);
  CHECK(p.highest_order <= 5); /* max_index */
  p.highest_order = 0;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK(p.highest_order <= 2); /* mu + 1 */
  p.highest_order = 0;
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(p.highest_order == 1); /* mu */
  sfdae_destroy(&solver);

  /* mu + 1 exceeds max_index. */
  p = no_fault();
  solver = create(&p);
  {
    sfdae_options options = loose_options(&p);
    options.max_index = 1;
    CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  }
  works(solver);
  CHECK(p.highest_order == 1);
  sfdae_destroy(&solver);
}

static int constant_matrix(double t, int order, double* matrix, void* user) {
  (void)t;
  CHECK(order == 0);
  ++*(int*)user;
  matrix[0] = 1;
  return 0;
}

static void constant_matrices_are_asked_for_once(void) {
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  double t, x[1] = {1}, E1[1], array[4];
  int calls = 0;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 1;
  problem.E = problem.A = constant_matrix;
  problem.constant_E = problem.constant_A = 1;
  problem.user = &calls;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0.5, E1, NULL, NULL, NULL, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0.5, 1, array, NULL, NULL), SFDAE_OK);
  CHECK(calls == 2); /* E once, A once */
  CHECK(fabs(x[0] - exp(1)) <= 10 * (1e-6 * exp(1) + 1e-6));
  sfdae_destroy(&solver);
}

/* ---- Use from inside --------------------------------------------------------------------------------- */

static int inside_uses = 0;

static void use_solver_from_inside(sfdae_solver* solver) {
  sfdae_solver* copy = solver;
  sfdae_options options;
  sfdae_characteristics c;
  sfdae_decision decision;
  sfdae_change change;
  sfdae_initial_report report;
  sfdae_statistics statistics;
  sfdae_derivative_check check;
  double t = unset, x[N] = {unset, unset, unset, unset, unset}, matrix[80];
  char text[100];
  size_t length = 77;
  int count = -1;
  inside_uses++;
  sfdae_options_init(&options, sizeof options);
  sfdae_characteristics_init(&c, sizeof c);
  sfdae_decision_init(&decision, sizeof decision);
  sfdae_change_init(&change, sizeof change);
  sfdae_initial_report_init(&report, sizeof report);
  sfdae_statistics_init(&statistics, sizeof statistics);
  sfdae_derivative_check_init(&check, sizeof check);
  matrix[0] = unset;

  CHECK_STATUS(sfdae_destroy(&copy), SFDAE_BUSY);
  CHECK(copy == solver);
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_BUSY);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, &c), SFDAE_BUSY);
  CHECK_STATUS(sfdae_make_consistent(solver, 0, x, x), SFDAE_BUSY);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, x), SFDAE_BUSY);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, x), SFDAE_BUSY);
  CHECK_STATUS(sfdae_step(solver, 1, &t, x, x), SFDAE_BUSY);
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, &length), SFDAE_BUSY);
  CHECK_STATUS(sfdae_save_checkpoint(solver, matrix, 80), SFDAE_BUSY);
  CHECK_STATUS(sfdae_restore_checkpoint(solver, matrix, 80), SFDAE_BUSY);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0, 1, matrix, NULL, NULL), SFDAE_BUSY);
  CHECK_STATUS(sfdae_get_projectors(solver, 0, matrix, NULL, NULL, NULL, &count), SFDAE_BUSY);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0, matrix, NULL, NULL, NULL, NULL, &t), SFDAE_BUSY);
  CHECK_STATUS(sfdae_get_jet(solver, 0, x, 0, matrix), SFDAE_BUSY);
  CHECK_STATUS(sfdae_get_derivative_array_at(solver, 0, x, 0, matrix, NULL, NULL), SFDAE_BUSY);
  CHECK_STATUS(sfdae_get_projectors_at(solver, 0, x, matrix, NULL, NULL, NULL, &count), SFDAE_BUSY);
  CHECK_STATUS(sfdae_get_strangeness_free_at(solver, 0, x, matrix, NULL, NULL, NULL, NULL, &t), SFDAE_BUSY);
  CHECK_STATUS(sfdae_get_extended_system(solver, 0, x, matrix, NULL, NULL, NULL, NULL, NULL), SFDAE_BUSY);
  CHECK_STATUS(sfdae_check_derivatives(solver, 0, 1, &check), SFDAE_BUSY);
  CHECK(sfdae_message(solver) != NULL);
  CHECK(t == unset && x[0] == unset && matrix[0] == unset && count == -1);

  /* Reading is harmless, whether it is refused or not. */
  CHECK(sfdae_get_characteristics(solver, &c) <= 0);
  CHECK(sfdae_get_num_decisions(solver, &count) <= 0);
  CHECK(sfdae_get_decision(solver, 0, &decision) <= 0);
  CHECK(sfdae_get_change(solver, &change) <= 0);
  CHECK(sfdae_get_initial_report(solver, &report) <= 0);
  CHECK(sfdae_get_statistics(solver, &statistics) <= 0);
  CHECK(sfdae_report(solver, text, sizeof text, NULL) <= 0);
}

static void solver_is_busy_in_its_own_callbacks(void) {
  static const char functions[] = {'E', 'A', 'f', 'p', 'm'};
  int phase, function;
  for (phase = 0; phase < PHASES; phase++)
    for (function = 0; function < 5; function++) {
      plan p = no_fault();
      sfdae_solver* solver = create(&p);
      const int failures_before = failures;
      if (functions[function] == 'm' && !phases[phase].integrates) {
        sfdae_destroy(&solver);
        continue;
      }
      prepare(solver, phases[phase].before);
      p.function = functions[function];
      p.kind = KINDS;
      p.call = -1;
      p.inside = 1;
      inside_uses = 0;
      CHECK_STATUS(phases[phase].run(solver), SFDAE_OK);
      CHECK(strcmp(sfdae_message(solver), "") == 0);
      CHECK(inside_uses > 0 || functions[function] == 'f' || functions[function] == 'p');
      p = no_fault();
      p.solver = solver;
      works(solver);
      sfdae_destroy(&solver);
      if (failures > failures_before) {
        fprintf(stderr, "  ... from %c in %s\n", functions[function], phases[phase].name);
        return;
      }
    }
}

/* Other solvers are free: one problem may solve another one in its callback. */
static sfdae_solver* other;
static int f_solves_another(double t, int order, double* vector, void* user) {
  double x[N], t_other;
  exact(0, x);
  CHECK_STATUS(sfdae_start(other, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(other, 1, &t_other, x, NULL), SFDAE_OK);
  return f(t, order, vector, user);
}

static void other_solvers_may_be_used_in_callbacks(void) {
  plan p = no_fault(), q = no_fault();
  sfdae_linear_problem problem = problem_with(&p);
  sfdae_options options = loose_options(&p);
  sfdae_solver* solver = NULL;
  other = create(&q);
  problem.f = f_solves_another;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  works(solver);
  sfdae_destroy(&solver);
  sfdae_destroy(&other);
}

/* ---- Stopping ------------------------------------------------------------------------------------------ */

static void requests_are_kept_for_the_next_call(void) {
  int phase;
  for (phase = 0; phase < PHASES; phase++) {
    plan p = no_fault();
    sfdae_solver* solver = create(&p);
    const int failures_before = failures;
    prepare(solver, phases[phase].before);
    CHECK_STATUS(sfdae_request_stop(solver), SFDAE_OK);
    CHECK_STATUS(sfdae_request_stop(solver), SFDAE_OK); /* twice is once */
    CHECK_STATUS(phases[phase].run(solver), SFDAE_STOPPED);
    CHECK_STATUS(phases[phase].run(solver), SFDAE_OK);
    works(solver);
    sfdae_destroy(&solver);
    if (failures > failures_before) fprintf(stderr, "  ... in %s\n", phases[phase].name);
  }
}

static void* request_soon(void* solver) {
  const struct timespec while_it_runs = {0, 50000000};
  nanosleep(&while_it_runs, NULL);
  CHECK_STATUS(sfdae_request_stop((sfdae_solver*)solver), SFDAE_OK);
  return NULL;
}

static sfdae_solver* solver_to_stop;
static void on_signal(int number) {
  (void)number;
  sfdae_request_stop(solver_to_stop);
}

/* A solution that would take 1e9 steps. */
static sfdae_solver* endless(plan* p) {
  sfdae_solver* solver = create(p);
  sfdae_options options = loose_options(p);
  options.max_step = 1e-6;
  options.max_steps = LONG_MAX;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  prepare(solver, STARTED);
  return solver;
}

static void other_threads_may_stop(void) {
  plan p = no_fault();
  sfdae_solver* solver = endless(&p);
  pthread_t thread;
  double t = unset, x[N];
  CHECK(pthread_create(&thread, NULL, request_soon, solver) == 0);
  CHECK_STATUS(sfdae_advance(solver, 1000, &t, x, NULL), SFDAE_STOPPED);
  CHECK(pthread_join(thread, NULL) == 0);
  CHECK(t >= 0 && t < 1000 && accurate(t, x));
  CHECK_STATUS(sfdae_advance(solver, t, &t, x, NULL), SFDAE_OK);
  works(solver);
  sfdae_destroy(&solver);
}

static void signal_handlers_may_stop(void) {
  plan p = no_fault();
  sfdae_solver* solver = endless(&p);
  double t = unset, x[N];
  solver_to_stop = solver;
  CHECK(signal(SIGALRM, on_signal) != SIG_ERR);
  alarm(1);
  CHECK_STATUS(sfdae_advance(solver, 1000, &t, x, NULL), SFDAE_STOPPED);
  CHECK(t >= 0 && t < 1000 && accurate(t, x));
  sfdae_destroy(&solver);
}

int main(void) {
  for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_AUTOMATIC; method++) {
    const int failures_before = failures;
    if (method != SFDAE_METHOD_AUTOMATIC) every_call_may_go_wrong();
    every_monitor_call_may_stop();
    functions_end_before_tout();
    requests_are_kept_for_the_next_call();
    no_order_is_asked_for_that_the_header_does_not_name();
    if (failures > failures_before) fprintf(stderr, "  ... with method %d\n", method);
  }
  method = SFDAE_METHOD_BDF;
  derivatives_that_are_missing_are_named_or_differenced();
  constant_matrices_are_asked_for_once();
  solver_is_busy_in_its_own_callbacks();
  other_solvers_may_be_used_in_callbacks();
  other_threads_may_stop();
  signal_handlers_may_stop();
  return failures != 0;
}
