/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Total derivatives and prescribed values that fail, are no numbers, are garbage, use the solver or stop it, at every
 * single call in every phase. The status is the documented one and the solver works again once the fault is gone.
 * Small: at every call one in three faults.
 */
#include <limits.h>
#include <stdio.h>

#include "nonlinear_pendulum.h"

enum kind { POSITIVE, LARGEST, NEGATIVE, SMALLEST, NOT_A_NUMBER, INFINITE, NO_ORDER, STOP, GARBAGE, KINDS };
static const char* const kind_names[KINDS] = {"1",   "INT_MAX",  "-7",           "INT_MIN", "NaN",
                                              "Inf", "no order", "request_stop", "garbage"};

typedef struct {
  sfdae_solver* solver;
  char function; /* 'F', 'x' (F_x), 'd' (F_x'), 'p' (prescribed values) or 0: none goes wrong */
  enum kind kind;
  long call; /* the call that goes wrong, counted from 1; 0: those at t > after */
  double after;
  long calls; /* of the function that goes wrong */
  int order;  /* asked for in the call that went wrong */
  int inside; /* use the solver */
} plan;

#define TOL 1e-4
static int method;
static const double last = 0.5;
static int garbage; /* values may be, too */

static void use_solver_from_inside(sfdae_solver* solver) {
  sfdae_characteristics c;
  sfdae_statistics s;
  sfdae_options options = default_options();
  double t = unset, x[N], value = 0;
  sfdae_characteristics_init(&c, sizeof c);
  sfdae_statistics_init(&s, sizeof s);
  exact(0, x);
  CHECK(sfdae_analyze_at(solver, 0, 1, x, &c) == SFDAE_BUSY);
  CHECK(sfdae_start(solver, 0, 1, x, NULL) == SFDAE_BUSY);
  CHECK(sfdae_advance(solver, 1, &t, x, NULL) == SFDAE_BUSY && t == unset);
  CHECK(sfdae_make_consistent(solver, 0, x, NULL) == SFDAE_BUSY);
  CHECK(sfdae_set_options(solver, &options) == SFDAE_BUSY);
  CHECK(sfdae_set_parameter(solver, "g", 1) == SFDAE_BUSY);
  CHECK(sfdae_check_total_derivatives(solver, 0, x, 0, NULL) == SFDAE_BUSY);
  CHECK(sfdae_destroy(&solver) == SFDAE_BUSY && solver != NULL);
  CHECK(sfdae_get_statistics(solver, &s) == SFDAE_OK);
  CHECK(sfdae_get_parameter(solver, "g", &value) == SFDAE_ILLEGAL_ARGUMENT);
}

/* Returns what the callback shall return; spoils its values if that is the fault. */
static int fault(plan* p, char function, double t, int order, double* values) {
  if (values == NULL || function != p->function) return 0;
  if (p->inside) use_solver_from_inside(p->solver);
  p->calls++;
  if (!(p->call ? p->calls == p->call : t > p->after)) return 0;
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
    case GARBAGE: values[0] = 1e300 * sin((double)p->calls); return 0;
    default: return 0;
  }
}

static int total_derivative(double t, int order, const double* jet, double* F, double* F_x, double* F_xdot,
                            void* user) {
  plan* p = (plan*)user;
  int status, i;
  for (i = 0; i < M; i++) CHECK(F[i] == 0);
  for (i = 0; i < M * N; i++) CHECK((!F_x || F_x[i] == 0) && (!F_xdot || F_xdot[i] == 0));
  CHECK(order >= 0 && order <= 6);
  status = pendulum_derivative(t, order, jet, F, F_x, F_xdot, NULL);
  if (status == 0) status = fault(p, 'F', t, order, F);
  if (status == 0) status = fault(p, 'x', t, order, F_x);
  if (status == 0) status = fault(p, 'd', t, order, F_xdot);
  return status;
}

static int prescribed(double t, int order, double* values, void* user) {
  const int status = push(t, order, values, NULL);
  return status ? status : fault((plan*)user, 'p', t, order, values);
}

static sfdae_solver* create(plan* p) {
  sfdae_nonlinear_problem problem = pendulum_problem();
  sfdae_options options = default_options();
  options.rtol = options.atol = TOL;
  options.method = method;
  problem.total_derivative = total_derivative;
  problem.prescribed_values = prescribed;
  problem.user = p;
  p->solver = CREATE(&problem, &options);
  return p->solver;
}

static plan no_fault(void) {
  plan p;
  memset(&p, 0, sizeof p);
  return p;
}

static void works(sfdae_solver* solver) {
  double t = -1, x[N];
  exact(0, x);
  CHECK_STATUS(sfdae_start(solver, 0, last, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, last, &t, x, NULL), SFDAE_OK);
  CHECK(t == last && accurate(t, x, TOL));
  CHECK(strcmp(sfdae_message(solver), "") == 0);
}

/* ---- Phases: one call each, with what it promises about its outputs ------------------------------- */

static int run_analyze(sfdae_solver* solver) {
  sfdae_characteristics c, before;
  double x[N];
  int status;
  sfdae_characteristics_init(&c, sizeof c);
  before = c;
  exact(0, x);
  x[4] += 0.1;
  status = sfdae_analyze_at(solver, 0, last, x, &c);
  if (status < 0 || status == SFDAE_STOPPED) CHECK(memcmp(&c, &before, sizeof c) == 0);
  else CHECK(garbage || (c.strangeness_index == 2 && c.differential == 2 && c.algebraic == 3 && c.undetermined == 1));
  return status;
}

static int initial(sfdae_solver* solver, int start) {
  double x[N], before[N], xdot[N] = {unset, unset, unset, unset, unset, unset};
  int status;
  exact(0, x);
  x[2] += 0.01;
  memcpy(before, x, sizeof x);
  status = start ? sfdae_start(solver, 0, last, x, xdot) : sfdae_make_consistent(solver, 0, x, xdot);
  if (status == SFDAE_OK) CHECK(xdot[0] != unset && violation(x) <= 1e-12);
  else CHECK(memcmp(x, before, sizeof x) == 0 && xdot[0] == unset && xdot[3] == unset);
  return status;
}
static int run_start(sfdae_solver* solver) { return initial(solver, 1); }
static int run_make_consistent(sfdae_solver* solver) { return initial(solver, 0); }

/* Whatever happens on the way, the last accepted point is returned; the last step may have gone past the end. */
static int run_advance(sfdae_solver* solver) {
  double t = unset, x[N] = {unset, unset, unset, unset, unset, unset}, xdot[N];
  const int status = sfdae_advance(solver, last, &t, x, xdot);
  CHECK(t >= 0 && t <= 4 * last && (garbage || accurate(t, x, TOL)));
  CHECK(status != SFDAE_OK || t == last);
  return status;
}

static int run_steps(sfdae_solver* solver) {
  double t = unset, x[N] = {unset, unset, unset, unset, unset, unset}, before = 0;
  int status;
  do {
    status = sfdae_step(solver, last, &t, x, NULL);
    CHECK(t >= before && t <= 4 * last && (garbage || accurate(t, x, TOL)));
    before = t;
  } while (status == SFDAE_STEP_TAKEN);
  return status;
}

static int run_check(sfdae_solver* solver) {
  sfdae_derivative_check check;
  double jet[N * 3];
  int i;
  for (i = 0; i < N * 3; i++) jet[i] = cos(1.0 + i);
  sfdae_derivative_check_init(&check, sizeof check);
  return sfdae_check_total_derivatives(solver, 0.5, jet, 1, &check);
}

enum preparation { NOTHING, ANALYZED, STARTED };
static const struct phase {
  const char* name;
  int (*run)(sfdae_solver*);
  enum preparation before;
} phases[] = {
    {"analyze", run_analyze, NOTHING}, {"make_consistent", run_make_consistent, NOTHING},
    {"start", run_start, NOTHING},     {"start, analyzed", run_start, ANALYZED},
    {"advance", run_advance, STARTED}, {"step", run_steps, STARTED},
    {"check", run_check, NOTHING},
};
enum { PHASES = sizeof phases / sizeof phases[0] };

static void prepare(sfdae_solver* solver, enum preparation before) {
  double x[N];
  exact(0, x);
  if (before == ANALYZED) CHECK_STATUS(sfdae_analyze_at(solver, 0, last, x, NULL), SFDAE_OK);
  if (before == STARTED) CHECK_STATUS(sfdae_start(solver, 0, last, x, NULL), SFDAE_OK);
}

/* ---- Every call fails once ------------------------------------------------------------------------ */

/* The library may find a way around a fault that happens once: by a smaller step, damping or another level. Garbage is
 * whatever the numbers lead to. What only refines x' is done without where it fails. */
static int documented(enum kind kind, int order, int status) {
  switch (kind) {
    case POSITIVE:
    case LARGEST: return status == SFDAE_CALLBACK_FAILED || status == SFDAE_OK;
    case NEGATIVE:
    case SMALLEST: return status == SFDAE_CALLBACK_STOPPED || status == SFDAE_OK;
    case NOT_A_NUMBER:
    case INFINITE: return status == SFDAE_NOT_FINITE || status == SFDAE_STEP_TOO_SMALL || status == SFDAE_OK;
    case NO_ORDER:
      return status == SFDAE_ORDER_MISSING || (order == 0 && status == SFDAE_CALLBACK_FAILED) || status == SFDAE_OK;
    case STOP: return status == SFDAE_STOPPED || status == SFDAE_OK; /* OK: it was the last callback */
    case GARBAGE: return status <= SFDAE_OK && status != SFDAE_INTERNAL && status != SFDAE_ILLEGAL_ARGUMENT;
    default: return 0;
  }
}

/* Lets the call number `call` go wrong; 0 if there was no such call. */
static int call_goes_wrong(const struct phase* phase, char function, enum kind kind, long call) {
  plan p = no_fault();
  sfdae_solver* solver = create(&p);
  const int failures_before = failures;
  int status, struck;
  prepare(solver, phase->before);
  p.function = function;
  p.kind = kind;
  p.call = call;
  garbage = kind == GARBAGE;
  status = phase->run(solver);
  garbage = 0;
  struck = p.calls >= call;
  if (struck && status != SFDAE_NOT_UNIQUE) CHECK(documented(kind, p.order, status));
  if (!struck) CHECK(status == SFDAE_OK || status == SFDAE_NOT_UNIQUE);
  if (status < 0) CHECK(strlen(sfdae_message(solver)) > 10);
  p.function = 0;
  if (kind == STOP && struck && status != SFDAE_STOPPED) { /* pending until one call returns it */
    double x[N];
    exact(0, x);
    CHECK_STATUS(sfdae_start(solver, 0, last, x, NULL), SFDAE_STOPPED);
  }
  works(solver);
  if (failures > failures_before)
    fprintf(stderr, "  ... %s, method %d: %s from call %ld of %c (order %d): %s\n", phase->name, method,
            kind_names[kind], call, function, p.order, sfdae_status_name(status));
  sfdae_destroy(&solver);
  return struck;
}

static void any_call_may_go_wrong(void) {
  static const char functions[] = {'F', 'x', 'd'};
  int phase, function, kind;
  for (phase = 0; phase < PHASES; phase++)
    for (function = 0; function < 3; function++)
      for (kind = 0; kind < KINDS; kind++) {
        long call = 1 + kind % stride(3);
        /* The first calls one by one, then some. */
        while (call_goes_wrong(&phases[phase], functions[function], (enum kind)kind, call) && call < 5000)
          call += call < 12 ? stride(3) : call < 60 ? 13 : call;
      }
}

/* From some time on; until then all is well. Jacobians are not asked for at every point. */
static void functions_may_end(void) {
  static const enum kind kinds[] = {POSITIVE, NEGATIVE, NOT_A_NUMBER, INFINITE};
  static const char functions[] = {'F', 'x', 'd'};
  int k, function, status;
  for (function = 0; function < 3; function++)
    for (k = 0; k < 4; k++) {
      plan p = no_fault();
      sfdae_solver* solver = create(&p);
      double t = unset, x[N];
      prepare(solver, STARTED);
      p.function = functions[function];
      p.kind = kinds[k];
      p.after = 0.3;
      status = sfdae_advance(solver, 20, &t, x, NULL);
      if (kinds[k] == NEGATIVE) CHECK(status == SFDAE_CALLBACK_STOPPED);
      CHECK(status < 0 && status != SFDAE_INTERNAL && strlen(sfdae_message(solver)) > 10);
      CHECK(t >= 0 && (function > 0 || t <= 0.3) && accurate(t, x, TOL));
      p.function = 0;
      exact(0, x);
      works(solver);
      sfdae_destroy(&solver);
    }
}

static void the_solver_is_busy_in_its_callbacks(void) {
  static const char functions[] = {'F', 'p'};
  int k, phase;
  for (k = 0; k < 2; k++)
    for (phase = 0; phase < PHASES; phase++) {
      plan p = no_fault();
      sfdae_solver* solver = create(&p);
      prepare(solver, phases[phase].before);
      p.function = functions[k];
      p.inside = 1;
      p.call = LONG_MAX;
      CHECK(phases[phase].run(solver) >= 0);
      p.function = 0;
      works(solver);
      sfdae_destroy(&solver);
    }
}

int main(void) {
  for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_RADAU; method++) {
    any_call_may_go_wrong();
    functions_may_end();
    the_solver_is_busy_in_its_callbacks();
  }
  return failures != 0;
}
