/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Modes: breakpoints, jumps by impulses, and what is refused. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sfdae/modes.h>

#include "checks.h"

#define NEAR(a, b, tol) CHECK(fabs((a) - (b)) <= (tol))

static int has_message(const sfdae_solver* solver, const char* text) {
  if (strstr(sfdae_message(solver), text)) return 1;
  fprintf(stderr, "\"%s\" is not in: %s\n", text, sfdae_message(solver));
  return 0;
}

/* Capacitors of C1 and C2 farad with a leak of 1 S beside the first, once a switch between them is closed:
 * C1 v1' + v1 + i = 0,  C2 v2' - i = 0,  v1 - v2 = 0. */
static int capacitors(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                      const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const double* C = (const double*)user;
  (void)record, (void)t;
  F[0] = sfdae_add(sfdae_multiply(sfdae_number(C[0]), xdot[0]),
                   sfdae_add(sfdae_multiply(sfdae_number(C[2]), x[0]), x[2]));
  F[1] = sfdae_subtract(sfdae_multiply(sfdae_number(C[1]), xdot[1]), x[2]);
  F[2] = sfdae_subtract(x[0], x[1]);
  return 0;
}

static sfdae_solver* create(sfdae_equations_function equations, int n, void* user, const sfdae_options* options) {
  sfdae_nonlinear_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = n;
  problem.equations = equations;
  problem.user = user;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, options), SFDAE_OK);
  return solver;
}

static void charge_is_kept(void) {
  double one[] = {1, 3, 1}, pico[] = {1e-12, 3e-12, 1e-3};
  double x[] = {2, 0, 0}, impulses[6], xdot[3];
  sfdae_solver* solver = create(capacitors, 3, one, NULL);
  CHECK_STATUS(sfdae_jump(solver, 0, 1, x, x, 2, impulses), SFDAE_OK);
  NEAR(x[0], 0.5, 1e-13);
  NEAR(x[1], 0.5, 1e-13);
  NEAR(impulses[2], 1.5, 1e-13); /* the charge that flows */
  NEAR(impulses[0], 0, 1e-13);
  NEAR(impulses[1], 0, 1e-13);
  CHECK(impulses[3] == 0 && impulses[4] == 0 && impulses[5] == 0); /* mu = 1: there is no delta' */
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_OK);
  NEAR(x[0], 0.5, 1e-13);
  NEAR(xdot[0], -0.125, 1e-12); /* 4 v' = -v */
  sfdae_destroy(&solver);

  solver = create(capacitors, 3, pico, NULL);
  x[0] = 2, x[1] = 0, x[2] = 0;
  CHECK_STATUS(sfdae_jump(solver, 0, 1e-9, x, x, 1, impulses), SFDAE_OK);
  NEAR(x[0], 0.5, 1e-13);
  NEAR(x[1], 0.5, 1e-13);
  NEAR(impulses[2], 1.5e-12, 1e-24);
  sfdae_destroy(&solver);
}

/* J1 w1' + T = 0,  J2 w2' - T = 0,  w1 = w2: inertias 1 and 2 with speeds 0.2 and 1. */
static int clutch(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                  sfdae_expression* F, void* user) {
  (void)record, (void)t, (void)user;
  F[0] = sfdae_add(xdot[0], x[2]);
  F[1] = sfdae_subtract(sfdae_multiply(sfdae_number(2), xdot[1]), x[2]);
  F[2] = sfdae_subtract(x[0], x[1]);
  return 0;
}

static void momentum_is_kept(void) {
  const double before[] = {0.2, 1, 0};
  double after[3], impulse[3];
  sfdae_solver* solver = create(clutch, 3, NULL, NULL);
  CHECK_STATUS(sfdae_jump(solver, 0, 1, before, after, 1, impulse), SFDAE_OK);
  NEAR(after[0], 2.2 / 3, 1e-13);
  NEAR(after[1], 2.2 / 3, 1e-13);
  NEAR(impulse[2], 0.2 - 2.2 / 3, 1e-13);
  sfdae_destroy(&solver);
}

static void jumps_are_checked(void) {
  double one[] = {1, 3, 1};
  const double before[] = {2, 0, 0}, not_finite[] = {2, NAN, 0};
  double after[] = {7, 8, 9}, impulse[] = {7, 8, 9};
  sfdae_options options;
  sfdae_solver* solver = create(capacitors, 3, one, NULL);
  CHECK_STATUS(sfdae_jump(NULL, 0, 1, before, after, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_jump(solver, 0, 0, before, after, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(solver, "must be finite and different"));
  CHECK_STATUS(sfdae_jump(solver, NAN, 1, before, after, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_jump(solver, 0, 1, NULL, after, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_jump(solver, 0, 1, before, NULL, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_jump(solver, 0, 1, not_finite, after, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(solver, "before contains NaN"));
  CHECK_STATUS(sfdae_jump(solver, 0, 1, before, after, 1, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_jump(solver, 0, 1, before, after, -1, impulse), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(solver, "orders = -1"));
  sfdae_options_init(&options, sizeof options);
  options.use_stop_time = 1;
  options.stop_time = 0;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_jump(solver, 0, 1, before, after, 1, impulse), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(solver, "stop_time"));
  CHECK_STATUS(sfdae_impact(solver, 0, NULL, before, after, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(solver, "multibody"));
  CHECK_STATUS(sfdae_get_jump(solver, NULL, NULL, after, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_jump(NULL, NULL, NULL, after, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(after[0] == 7 && after[1] == 8 && after[2] == 9 && impulse[0] == 7);
  sfdae_destroy(&solver);
}

static void breakpoints_are_checked(void) {
  const double in_order[] = {1, 2, 3}, twice[] = {1, 2, 2}, back[] = {1, 3, 2}, not_finite[] = {1, 2, NAN};
  const int kinds[] = {SFDAE_BREAKPOINT_KINK, SFDAE_BREAKPOINT_JUMP, 5};
  double one[] = {1, 3, 1};
  sfdae_solver* solver = create(capacitors, 3, one, NULL);
  CHECK_STATUS(sfdae_set_breakpoints(NULL, 0, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_breakpoints(solver, -1, in_order, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(solver, "count = -1"));
  CHECK_STATUS(sfdae_set_breakpoints(solver, 3, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_breakpoints(solver, 3, twice, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(solver, "t[1] = t[2] = 2: breakpoints must be different"));
  CHECK_STATUS(sfdae_set_breakpoints(solver, 3, back, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(solver, "t[2] = 2 is before t[1] = 3: breakpoints must be in order"));
  CHECK_STATUS(sfdae_set_breakpoints(solver, 3, not_finite, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(solver, "t[2] is nan"));
  CHECK_STATUS(sfdae_set_breakpoints(solver, 3, in_order, kinds), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(solver, "kinds[2] = 5"));
  CHECK_STATUS(sfdae_set_breakpoints(solver, 2, in_order, kinds), SFDAE_OK);
  CHECK_STATUS(sfdae_set_breakpoints(solver, 0, NULL, NULL), SFDAE_OK);
  sfdae_destroy(&solver);
}

/* x1' = f(t),  0 = x2 - x1 - f(t),  0 = x2' - x3 with f = |t - 1/2| (kink) or a step from 0 to 1 at t = 1/2. */
typedef struct {
  int has_jump;
  double nearest;
} input;

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = 1, matrix[2 + 3 * 1] = 1;
  return 0;
}
static int A(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[1 + 3 * 0] = -1, matrix[1 + 3 * 1] = 1, matrix[2 + 3 * 2] = 1;
  return 0;
}
static double value(const input* in, double t, int order) {
  if (in->has_jump) return order == 0 && t >= 0.5 ? 1 : 0;
  return order == 0 ? fabs(t - 0.5) : order > 1 ? 0 : t < 0.5 ? -1 : 1;
}
static int f(double t, int order, double* vector, void* user) {
  input* in = (input*)user;
  if (fabs(t - 0.5) < in->nearest) in->nearest = fabs(t - 0.5);
  vector[0] = value(in, t, order);
  vector[1] = -value(in, t, order);
  return 0;
}

static sfdae_solver* driven(input* in, int method) {
  sfdae_linear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  problem.num_equations = problem.num_unknowns = 3;
  problem.E = E;
  problem.A = A;
  problem.f = f;
  problem.constant_E = problem.constant_A = 1;
  problem.user = in;
  options.method = method;
  options.rtol = options.atol = 1e-8;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  in->nearest = HUGE_VAL;
  return solver;
}

static double integral(double t) { return 0.125 + (t < 0.5 ? -1 : 1) * (t - 0.5) * (t - 0.5) / 2; }

/* x1 = the integral of f from 0, x2 = x1 + f, x3 = f + f'. */
static void kinks_are_crossed(int method) {
  input in = {0, HUGE_VAL};
  const double at[] = {0.5};
  double t = 0, x[] = {0, 0.5, -0.5}, xdot[3], outputs[] = {0.3, 0.5, 0.500001, 1};
  int k;
  sfdae_solver* solver = driven(&in, method);
  CHECK_STATUS(sfdae_set_breakpoints(solver, 1, at, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_OK);
  for (k = 0; k < 4; ++k) {
    CHECK_STATUS(sfdae_advance(solver, outputs[k], &t, x, xdot), SFDAE_OK);
    NEAR(x[0], integral(t), 1e-7);
    NEAR(x[1], integral(t) + fabs(t - 0.5), 1e-7);
    NEAR(x[2], fabs(t - 0.5) + (t < 0.5 ? -1 : 1), 1e-7);
  }
  CHECK_STATUS(sfdae_get_jump(solver, NULL, NULL, x, NULL), SFDAE_NOT_STARTED);
  sfdae_destroy(&solver);
}

/* x3 has an impulse of 1 where f jumps; as a kink it is refused by name. */
static void jumps_are_crossed(int method) {
  input in = {1, HUGE_VAL};
  const double at[] = {0.5};
  const int kinds[] = {SFDAE_BREAKPOINT_JUMP};
  double t = 0, x[] = {0, 0, 0}, xdot[3], before[3], after[3], impulse[3], outputs[] = {0.3, 0.5, 0.500001, 1};
  int k;
  sfdae_solution* solution = NULL;
  sfdae_solver* solver = driven(&in, method);
  CHECK_STATUS(sfdae_set_breakpoints(solver, 1, at, kinds), SFDAE_OK);
  CHECK_STATUS(sfdae_create_solution(&solution), SFDAE_OK);
  CHECK_STATUS(sfdae_record_solution(solver, solution), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_OK);
  for (k = 0; k < 4; ++k) {
    CHECK_STATUS(sfdae_advance(solver, outputs[k], &t, x, xdot), SFDAE_OK);
    NEAR(x[0], t < 0.5 ? 0 : t - 0.5, 1e-7);
    NEAR(x[1], t < 0.5 ? 0 : t + 0.5, 1e-7);
    NEAR(x[2], t < 0.5 ? 0 : 1, 1e-7);
  }
  CHECK(in.nearest >= 0.7e-14); /* 64 roundings of 1/2 */
  CHECK_STATUS(sfdae_get_jump(solver, &t, before, after, impulse), SFDAE_OK);
  NEAR(t, 0.5, 1e-13);
  NEAR(before[1], 0, 1e-7);
  NEAR(after[1], 1, 1e-7);
  NEAR(impulse[2], 1, 1e-7);
  CHECK_STATUS(sfdae_evaluate_solution(solution, 0.499, x, NULL), SFDAE_OK);
  NEAR(x[1], 0, 1e-6);
  CHECK_STATUS(sfdae_evaluate_solution(solution, 0.501, x, NULL), SFDAE_OK);
  NEAR(x[1], 1.001, 1e-6);
  sfdae_destroy_solution(&solution);

  CHECK_STATUS(sfdae_set_breakpoints(solver, 1, at, NULL), SFDAE_OK);
  x[0] = x[1] = x[2] = 0;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, xdot), SFDAE_OK); /* what is called a kink is found to be a jump */
  NEAR(x[0], 0.5, 1e-7);
  NEAR(x[1], 1.5, 1e-7);
  NEAR(x[2], 1, 1e-7);
  sfdae_destroy(&solver);
}

/* Where the data end at the jump nothing is evaluated after it. */
static void jump_at_stop_time(void) {
  input in = {1, HUGE_VAL};
  const double at[] = {0.5};
  const int kinds[] = {SFDAE_BREAKPOINT_JUMP};
  double t = 0, x[] = {0, 0, 0};
  sfdae_options options;
  sfdae_solver* solver = driven(&in, SFDAE_METHOD_BDF);
  sfdae_options_init(&options, sizeof options);
  options.use_stop_time = 1;
  options.stop_time = 0.5;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_set_breakpoints(solver, 1, at, kinds), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 0.5, &t, x, NULL), SFDAE_OK);
  CHECK(t == 0.5);
  NEAR(x[1], 0, 1e-6);
  CHECK(in.nearest >= 0.7e-14); /* 64 roundings of 1/2 */
  sfdae_destroy(&solver);
}

static int passes_half(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = x[1] - 0.5;
  return 0;
}

/* A jump of x across a zero of an event function is an event. */
static void events_at_jumps(void) {
  input in = {1, HUGE_VAL};
  const double at[] = {0.5};
  const int kinds[] = {SFDAE_BREAKPOINT_JUMP};
  double t = 0, x[] = {0, 0, 0};
  sfdae_solver* solver = driven(&in, SFDAE_METHOD_RADAU);
  CHECK_STATUS(sfdae_set_breakpoints(solver, 1, at, kinds), SFDAE_OK);
  CHECK_STATUS(sfdae_set_events(solver, 1, passes_half, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_EVENT);
  NEAR(t, 0.5, 1e-12);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  NEAR(x[1], 1.5, 1e-6);
  sfdae_destroy(&solver);
}

/* Half of an integration from a checkpoint between breakpoints. */
static void checkpoints_between_breakpoints(void) {
  input in = {1, HUGE_VAL};
  const double at[] = {0.25, 0.5};
  const int kinds[] = {SFDAE_BREAKPOINT_KINK, SFDAE_BREAKPOINT_JUMP};
  double t = 0, x[] = {0, 0, 0}, y[3], checkpoint[2000];
  size_t length;
  sfdae_solver *solver = driven(&in, SFDAE_METHOD_BDF), *other = driven(&in, SFDAE_METHOD_BDF);
  CHECK_STATUS(sfdae_set_breakpoints(solver, 2, at, kinds), SFDAE_OK);
  CHECK_STATUS(sfdae_set_breakpoints(other, 2, at, kinds), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 0.3, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, &length), SFDAE_OK);
  CHECK(length <= 2000);
  CHECK_STATUS(sfdae_save_checkpoint(solver, checkpoint, length), SFDAE_OK);
  CHECK_STATUS(sfdae_restore_checkpoint(other, checkpoint, length), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(other, 1, &t, y, NULL), SFDAE_OK);
  NEAR(y[1], 1.5, 1e-7);
  CHECK(memcmp(x, y, sizeof x) == 0);
  sfdae_destroy(&solver);
  sfdae_destroy(&other);
}

int main(void) {
  const int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC};
  int k;
  charge_is_kept();
  momentum_is_kept();
  jumps_are_checked();
  breakpoints_are_checked();
  for (k = 0; k < 3; ++k) {
    kinks_are_crossed(methods[k]);
    jumps_are_crossed(methods[k]);
  }
  jump_at_stop_time();
  events_at_jumps();
  checkpoints_between_breakpoints();
  return failures > 0;
}
