/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Hybrid systems: transitions of all kinds between modes of different index, against solutions known piece by piece;
 * accumulation; checkpoints; what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sfdae/hybrid.h>

#include "checks.h"

#define NEAR(a, b, tol) CHECK(fabs((a) - (b)) <= (tol))

static const double pi = 3.14159265358979323846;

static int has_message(const sfdae_hybrid* hybrid, const char* text) {
  if (strstr(sfdae_get_hybrid_message(hybrid), text)) return 1;
  fprintf(stderr, "\"%s\" is not in: %s\n", text, sfdae_get_hybrid_message(hybrid));
  return 0;
}

static sfdae_solver* create(sfdae_equations_function equations, int n, void* user, int method) {
  sfdae_nonlinear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  problem.num_equations = problem.num_unknowns = n;
  problem.equations = equations;
  problem.user = user;
  options.method = method;
  options.rtol = options.atol = 1e-8;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  return solver;
}

/* Two modes of the same equations, whose parameter `name` is 0 in the first and 1 in the second. */
static sfdae_hybrid* create_pair(sfdae_equations_function equations, int n, void* user, const char* name, int method,
                                 sfdae_solver** solvers) {
  sfdae_hybrid* hybrid = NULL;
  int k, mode = -1;
  CHECK_STATUS(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  for (k = 0; k < 2; ++k) {
    solvers[k] = create(equations, n, user, method);
    CHECK_STATUS(sfdae_set_parameter(solvers[k], name, k), SFDAE_OK);
    CHECK_STATUS(sfdae_add_mode(hybrid, solvers[k], k == 0 ? "off" : "on", &mode), SFDAE_OK);
    CHECK(mode == k);
  }
  return hybrid;
}

static void destroy(sfdae_hybrid** hybrid, sfdae_solver** solvers, int count) {
  int k;
  CHECK_STATUS(sfdae_destroy_hybrid(hybrid), SFDAE_OK);
  CHECK(*hybrid == NULL);
  for (k = 0; k < count; ++k) CHECK_STATUS(sfdae_destroy(&solvers[k]), SFDAE_OK);
}

static sfdae_transition transition_of(int from, int to, int kind, sfdae_event_function function) {
  sfdae_transition transition;
  sfdae_transition_init(&transition, sizeof transition);
  transition.from = from;
  transition.to = to;
  transition.kind = kind;
  transition.function = function;
  return transition;
}

static sfdae_mode mode_of(const sfdae_hybrid* hybrid, int k) {
  sfdae_mode mode;
  sfdae_mode_init(&mode, sizeof mode);
  CHECK_STATUS(sfdae_get_mode(hybrid, k, &mode), SFDAE_OK);
  return mode;
}

/* C1 x1' + leak x1 + x3 = 0,  C2 x2' - x3 = 0,  x3 = 0 or x1 = x2: capacitors and a switch, inertias and a clutch. */
static int joined(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                  sfdae_expression* F, void* user) {
  const double* C = (const double*)user;
  const sfdae_expression closed = sfdae_parameter(record, "closed", 0),
                         open = sfdae_subtract(sfdae_number(1), closed);
  (void)t;
  F[0] = sfdae_add(sfdae_multiply(sfdae_number(C[0]), xdot[0]),
                   sfdae_add(sfdae_multiply(sfdae_number(C[2]), x[0]), x[2]));
  F[1] = sfdae_subtract(sfdae_multiply(sfdae_number(C[1]), xdot[1]), x[2]);
  F[2] = sfdae_add(sfdae_multiply(closed, sfdae_subtract(x[0], x[1])), sfdae_multiply(open, x[2]));
  return 0;
}

static void join(double* C, double x1, double x2, double after, double impulse) {
  sfdae_solver* solvers[2];
  sfdae_hybrid* hybrid = create_pair(joined, 3, C, "closed", SFDAE_METHOD_BDF, solvers);
  sfdae_transition close = transition_of(0, 1, SFDAE_TRANSITION_TIME, NULL);
  sfdae_passage passage;
  double t = 0, x[3] = {0, 0, 0}, xdot[3], before[3], values[3], factors[3];
  int mode = -1;
  x[0] = x1, x[1] = x2;
  close.time = 1;
  CHECK_STATUS(sfdae_add_transition(hybrid, &close, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_current_mode(hybrid, &mode), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 2, x, xdot), SFDAE_OK);
  CHECK_STATUS(sfdae_get_passage_values(hybrid, before, values, factors), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1, &t, x, xdot), SFDAE_OK);
  CHECK(t == 1);
  NEAR(x[0], after, 1e-7);
  NEAR(x[1], after, 1e-7);
  CHECK_STATUS(sfdae_get_current_mode(hybrid, &mode), SFDAE_OK);
  CHECK(mode == 1);
  sfdae_passage_init(&passage, sizeof passage);
  CHECK_STATUS(sfdae_get_passage(hybrid, 0, &passage), SFDAE_OK);
  CHECK(passage.t == 1 && passage.from == 0 && passage.to == 1 && passage.transition == 0);
  CHECK(passage.impulse_component == 2);
  NEAR(passage.largest_impulse, fabs(impulse), 1e-7);
  CHECK_STATUS(sfdae_get_passage_values(hybrid, before, values, factors), SFDAE_OK);
  NEAR(before[1], x2, 1e-7);
  NEAR(values[1], after, 1e-7);
  NEAR(factors[2], impulse, 1e-7);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 2, &t, x, xdot), SFDAE_OK);
  NEAR(x[0], after * exp(-C[2] / (C[0] + C[1])), 1e-6);
  NEAR(mode_of(hybrid, 0).duration, 1, 1e-15);
  NEAR(mode_of(hybrid, 1).duration, 1, 1e-15);
  CHECK(mode_of(hybrid, 0).strangeness_index == 0 && mode_of(hybrid, 1).strangeness_index == 1);
  destroy(&hybrid, solvers, 2);
}

/* An ideal diode charges a capacitor of 1 F with 0.5 Ohm beside it from sin(2 pi t): x = (v, i, u),
 * v' + 2 v = i,  u = sin(2 pi t) - v,  u = 0 (on, mu = 1) or i = 0 (off, mu = 0). */
static int rectifier(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression on = sfdae_parameter(record, "on", 0), off = sfdae_subtract(sfdae_number(1), on);
  const sfdae_expression source = sfdae_sin(sfdae_multiply(sfdae_number(2 * pi), t));
  (void)user;
  F[0] = sfdae_add(xdot[0], sfdae_subtract(sfdae_multiply(sfdae_number(2), x[0]), x[1]));
  F[1] = sfdae_subtract(sfdae_add(x[2], x[0]), source);
  F[2] = sfdae_add(sfdae_multiply(on, x[2]), sfdae_multiply(off, x[1]));
  return 0;
}
static int voltage(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = x[2];
  return 0;
}
static int reverse_current(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = -x[1];
  return 0;
}

static sfdae_hybrid* create_rectifier(int method, sfdae_solver** solvers) {
  sfdae_hybrid* hybrid = create_pair(rectifier, 3, NULL, "on", method, solvers);
  const sfdae_transition on = transition_of(0, 1, SFDAE_TRANSITION_CONDITION, voltage),
                         off = transition_of(1, 0, SFDAE_TRANSITION_CONDITION, reverse_current);
  int number = -1;
  CHECK_STATUS(sfdae_add_transition(hybrid, &on, &number), SFDAE_OK);
  CHECK(number == 0);
  CHECK_STATUS(sfdae_add_transition(hybrid, &off, &number), SFDAE_OK);
  CHECK(number == 1);
  return hybrid;
}

/* When it stops to conduct in every period: i = 2 pi cos + 2 sin = 0; later exp(-2 t). */
static double when_off(void) { return (pi - atan(pi)) / (2 * pi); }
static double exact(double t, double* when_on) {
  const double t_off = when_off(), period = floor(t), phase = t - period;
  double low = 0, high = 0.25;
  while (high - low > 1e-16) { /* from the period before: sin(2 pi t) = sin(2 pi t_off) exp(-2 (1 + t - t_off)) */
    const double middle = (low + high) / 2;
    if (middle == low || middle == high) break;
    if (sin(2 * pi * middle) < sin(2 * pi * t_off) * exp(-2 * (1 + middle - t_off))) low = middle;
    else high = middle;
  }
  if (when_on != NULL) *when_on = low;
  if (period > 0 && phase < low) return sin(2 * pi * t_off) * exp(-2 * (1 + phase - t_off));
  return phase < t_off ? sin(2 * pi * phase) : sin(2 * pi * t_off) * exp(-2 * (phase - t_off));
}

static void modes_of_different_index(int method) {
  sfdae_solver* solvers[2];
  sfdae_hybrid* hybrid = create_rectifier(method, solvers);
  sfdae_statistics statistics, left;
  sfdae_solution* solution = NULL;
  sfdae_passage passage;
  double t = 0, x[3] = {0, 0, 0}, xdot[3], when_on, duration;
  long count = 0, k;
  CHECK_STATUS(sfdae_create_solution(&solution), SFDAE_OK);
  CHECK_STATUS(sfdae_record_hybrid(hybrid, solution), SFDAE_OK);
  /* u = sin(2 pi t) - v leaves zero upward */
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 20, x, xdot), SFDAE_OK);
  for (k = 1; k <= 80; ++k) {
    CHECK_STATUS(sfdae_advance_hybrid(hybrid, 0.25 * (double)k, &t, x, k % 2 ? NULL : xdot), SFDAE_OK);
    CHECK(t == 0.25 * (double)k);
    NEAR(x[0], exact(t, NULL), 2e-6);
    NEAR(x[2], sin(2 * pi * t) - x[0], 1e-9);
  }
  CHECK_STATUS(sfdae_get_num_passages(hybrid, &count), SFDAE_OK);
  CHECK(count == 40); /* 20 times on and off */
  sfdae_passage_init(&passage, sizeof passage);
  CHECK_STATUS(sfdae_get_passage(hybrid, 38, &passage), SFDAE_OK);
  exact(19.5, &when_on);
  NEAR(passage.t, 19 + when_on, 1e-6);
  CHECK_STATUS(sfdae_get_passage(hybrid, 39, &passage), SFDAE_OK);
  NEAR(passage.t, 19 + when_off(), 1e-6);
  CHECK(mode_of(hybrid, 0).num_analyses == 1 && mode_of(hybrid, 1).num_analyses == 1);
  CHECK(mode_of(hybrid, 0).visits == 21 && mode_of(hybrid, 1).visits == 20);
  CHECK(mode_of(hybrid, 0).strangeness_index == 0 && mode_of(hybrid, 1).strangeness_index == 1);
  CHECK(mode_of(hybrid, 0).differential == 1 && mode_of(hybrid, 1).differential == 0);
  duration = mode_of(hybrid, 0).duration + mode_of(hybrid, 1).duration;
  NEAR(duration, 20, 1e-12);
  NEAR(mode_of(hybrid, 1).duration, 20 * when_off() - 19 * when_on, 1e-5);
  sfdae_statistics_init(&statistics, sizeof statistics);
  sfdae_statistics_init(&left, sizeof left);
  CHECK_STATUS(sfdae_get_hybrid_statistics(hybrid, &statistics), SFDAE_OK);
  CHECK_STATUS(sfdae_get_statistics(solvers[0], &left), SFDAE_OK);
  CHECK(statistics.steps == mode_of(hybrid, 0).steps + mode_of(hybrid, 1).steps);
  CHECK(statistics.steps > left.steps && statistics.evaluations_f > left.evaluations_f);
  for (k = 1; k < 200; ++k) {
    CHECK_STATUS(sfdae_evaluate_solution(solution, 0.0999 * (double)k, x, NULL), SFDAE_OK);
    NEAR(x[0], exact(0.0999 * (double)k, NULL), 5e-6);
  }
  sfdae_destroy_solution(&solution);
  destroy(&hybrid, solvers, 2);
}

static void transitions_one_by_one(void) {
  sfdae_solver* solvers[2];
  sfdae_hybrid* hybrid = create_rectifier(SFDAE_METHOD_RADAU, solvers);
  double t = 0, x[3] = {0, 0, 0}, when_on;
  int mode = -1;
  exact(1, &when_on);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 1, 0.1, 3, x, NULL), SFDAE_VALUES_CHANGED); /* v = 0 does not fit */
  NEAR(x[0], sin(0.2 * pi), 1e-9);
  CHECK_STATUS(sfdae_advance_to_transition(hybrid, 3, &t, x, NULL), SFDAE_EVENT);
  NEAR(t, when_off(), 1e-6);
  CHECK_STATUS(sfdae_get_current_mode(hybrid, &mode), SFDAE_OK);
  CHECK(mode == 0);
  CHECK_STATUS(sfdae_advance_to_transition(hybrid, 3, &t, x, NULL), SFDAE_EVENT);
  NEAR(t, 1 + when_on, 1e-6);
  CHECK_STATUS(sfdae_advance_to_transition(hybrid, 1.2, &t, x, NULL), SFDAE_OK);
  CHECK(t == 1.2);
  destroy(&hybrid, solvers, 2);
}

/* Half of a run from a checkpoint, in another hybrid system. */
static void checkpoints(void) {
  sfdae_solver *solvers[2], *others[2];
  sfdae_hybrid *hybrid = create_rectifier(SFDAE_METHOD_BDF, solvers),
               *other = create_rectifier(SFDAE_METHOD_BDF, others);
  double t = 0, x[3] = {0, 0, 0}, y[3], *checkpoint;
  size_t length = 0, k;
  long count = 0, counted = 0;
  sfdae_passage passage;
  CHECK_STATUS(sfdae_get_hybrid_checkpoint_length(hybrid, &length), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 5, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1.7, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_hybrid_checkpoint_length(hybrid, &length), SFDAE_OK);
  checkpoint = (double*)malloc(length * sizeof(double));
  CHECK_STATUS(sfdae_save_hybrid_checkpoint(hybrid, checkpoint, length - 1), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_save_hybrid_checkpoint(hybrid, checkpoint, length), SFDAE_OK);
  for (k = 0; k < length; k += 1 + k / 2)
    CHECK_STATUS(sfdae_restore_hybrid_checkpoint(other, checkpoint, k), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_restore_hybrid_checkpoint(other, checkpoint, length), SFDAE_OK);
  CHECK_STATUS(sfdae_get_num_passages(hybrid, &count), SFDAE_OK);
  CHECK_STATUS(sfdae_get_num_passages(other, &counted), SFDAE_OK);
  CHECK(count == 4 && counted == 4);
  sfdae_passage_init(&passage, sizeof passage);
  CHECK_STATUS(sfdae_get_passage(other, 3, &passage), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 5, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(other, 5, &t, y, NULL), SFDAE_OK);
  CHECK(memcmp(x, y, sizeof x) == 0);
  CHECK(mode_of(other, 1).visits == mode_of(hybrid, 1).visits && mode_of(other, 0).visits == 6);
  checkpoint[2] = 7; /* modes */
  CHECK_STATUS(sfdae_restore_hybrid_checkpoint(other, checkpoint, length), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(other, "another hybrid system"));
  free(checkpoint);
  destroy(&hybrid, solvers, 2);
  destroy(&other, others, 2);
}

/* h' = v, v' = -g. */
static int flight(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                  sfdae_expression* F, void* user) {
  (void)record, (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[1]);
  F[1] = sfdae_add(xdot[1], sfdae_number(9.81));
  return 0;
}
static int height(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = x[0];
  return 0;
}
static int bounce(double t, int from, int to, const double* before, double* after, void* user) {
  (void)t;
  CHECK(from == 0 && to == 0 && after[1] == before[1]);
  after[0] = 0;
  after[1] = -*(double*)user * before[1];
  return 0;
}

static void bounces_accumulate(double e) {
  const double v0 = 5, limit = 2 * v0 / (9.81 * (1 - e));
  sfdae_solver* solver = create(flight, 2, NULL, SFDAE_METHOD_BDF);
  sfdae_transition transition = transition_of(0, 0, SFDAE_TRANSITION_ZERO, height);
  sfdae_hybrid* hybrid = NULL;
  double t = 0, x[2] = {0, 5}, found = 0;
  CHECK_STATUS(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(hybrid, solver, NULL, NULL), SFDAE_OK);
  transition.direction = -1;
  transition.jump = bounce;
  transition.user = &e;
  CHECK_STATUS(sfdae_add_transition(hybrid, &transition, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 100, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 2 * v0 / 9.81 * (1 + e / 2), &t, x, NULL), SFDAE_OK);
  NEAR(x[0], e * e * v0 * v0 / (2 * 9.81), 1e-6); /* at its highest */
  CHECK_STATUS(sfdae_get_accumulation(hybrid, &found), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 100, &t, x, NULL), SFDAE_ZENO);
  CHECK(has_message(hybrid, "accumulate at t = "));
  CHECK_STATUS(sfdae_get_accumulation(hybrid, &found), SFDAE_OK);
  NEAR(found, limit, 1e-5 * limit);
  CHECK(t <= found && found - t <= 0.02 * limit);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 100, &t, x, NULL), SFDAE_ZENO);
  x[0] = 0, x[1] = 5;
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 100, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_accumulation(hybrid, &found), SFDAE_NOT_STARTED);
  destroy(&hybrid, &solver, 1);
}

/* x' = 1 below 0, -1 above: no way on. */
static int toward_zero(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                       const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression above = sfdae_parameter(record, "above", 0);
  (void)t, (void)x, (void)user;
  F[0] = sfdae_add(xdot[0], sfdae_subtract(sfdae_multiply(sfdae_number(2), above), sfdae_number(1)));
  return 0;
}
static int is_above(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = x[0];
  return 0;
}
static int is_below(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = -x[0];
  return 0;
}

static void chattering_ends(double start) {
  sfdae_solver* solvers[2];
  sfdae_hybrid* hybrid = create_pair(toward_zero, 1, NULL, "above", SFDAE_METHOD_BDF, solvers);
  const sfdae_transition up = transition_of(0, 1, SFDAE_TRANSITION_CONDITION, is_above),
                         down = transition_of(1, 0, SFDAE_TRANSITION_CONDITION, is_below);
  double t = 0, x[1], found = 0;
  x[0] = start;
  CHECK_STATUS(sfdae_add_transition(hybrid, &up, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_add_transition(hybrid, &down, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1, &t, x, NULL), SFDAE_ZENO);
  CHECK(has_message(hybrid, "each leads back at once"));
  CHECK_STATUS(sfdae_get_accumulation(hybrid, &found), SFDAE_OK);
  NEAR(found, -start, 1e-7);
  destroy(&hybrid, solvers, 2);
}

/* x' = x > y ? -2 : 2,  y' = y > x ? -3 : 1.5 as three modes of x' = 2 - 4 a,  y' = -3 + 4.5 a: a = 0 (x < y), a = 1
 * (x > y), and the motion along x = y, where a, the part of the second, follows from x' = y': a = 10 / 17 (mu = 1).
 * From (1.5, 1) x = y is reached at t = 1/7 in 17/14; then x' = -6 / 17, and x(1) = 17/14 - 36/119 = 217/238. */
static int sides(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                 sfdae_expression* F, void* user) {
  const sfdae_expression slides = sfdae_parameter(record, "slides", 0), above = sfdae_parameter(record, "above", 0);
  const sfdae_expression held = sfdae_subtract(x[2], above);
  (void)t, (void)user;
  F[0] = sfdae_subtract(sfdae_add(xdot[0], sfdae_multiply(sfdae_number(4), x[2])), sfdae_number(2));
  F[1] = sfdae_add(sfdae_subtract(xdot[1], sfdae_multiply(sfdae_number(4.5), x[2])), sfdae_number(3));
  F[2] = sfdae_add(held, sfdae_multiply(slides, sfdae_subtract(sfdae_subtract(x[0], x[1]), held)));
  return 0;
}
static int distance(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot;
  g[0] = *(const double*)user * (x[0] - x[1]);
  return 0;
}
static int part_left(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot;
  g[0] = *(const double*)user > 0 ? x[2] - 1 : -x[2];
  return 0;
}

static void slides_in_a_mode_of_its_own(double x0, double y0) {
  double sign[] = {1, -1}, t = 0, x[3];
  sfdae_solver* solvers[3]; /* below, above, along */
  sfdae_hybrid* hybrid = NULL;
  sfdae_passage passage;
  int k, mode = -1;
  const double first = fabs(x0 - y0) / (x0 > y0 ? 3.5 : 5), reached = x0 + first * (x0 > y0 ? -2 : 2);
  CHECK_STATUS(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  for (k = 0; k < 3; ++k) {
    solvers[k] = create(sides, 3, NULL, SFDAE_METHOD_BDF);
    CHECK_STATUS(sfdae_set_parameter(solvers[k], "above", k == 1), SFDAE_OK);
    CHECK_STATUS(sfdae_set_parameter(solvers[k], "slides", k == 2), SFDAE_OK);
    CHECK_STATUS(sfdae_add_mode(hybrid, solvers[k], NULL, NULL), SFDAE_OK);
  }
  for (k = 0; k < 2; ++k) {
    sfdae_transition reach = transition_of(k, 2, SFDAE_TRANSITION_CONDITION, distance),
                     leave = transition_of(2, k, SFDAE_TRANSITION_CONDITION, part_left);
    reach.user = &sign[k];
    leave.user = &sign[1 - k];
    CHECK_STATUS(sfdae_add_transition(hybrid, &reach, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_add_transition(hybrid, &leave, NULL), SFDAE_OK);
  }
  x[0] = x0, x[1] = y0, x[2] = x0 > y0;
  CHECK_STATUS(sfdae_start_hybrid(hybrid, x0 > y0, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1, &t, x, NULL), SFDAE_OK);
  NEAR(x[0], reached - 6.0 / 17 * (1 - first), 1e-6);
  NEAR(x[1], x[0], 1e-12);
  NEAR(x[2], 10.0 / 17, 1e-6);
  CHECK_STATUS(sfdae_get_current_mode(hybrid, &mode), SFDAE_OK);
  CHECK(mode == 2);
  sfdae_passage_init(&passage, sizeof passage);
  CHECK_STATUS(sfdae_get_passage(hybrid, 1, &passage), SFDAE_ILLEGAL_ARGUMENT); /* there was one */
  CHECK(mode_of(hybrid, 2).strangeness_index == 1);
  destroy(&hybrid, solvers, 3);
}

static int upward(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)x;
  ++*(int*)user;
  g[0] = xdot[0] - 5;
  return 0;
}
static int fails(double t, int from, int to, const double* before, double* after, void* user) {
  (void)t, (void)from, (void)to, (void)before, (void)user;
  after[0] = 99;
  return -3;
}
static int not_finite(double t, int from, int to, const double* before, double* after, void* user) {
  (void)t, (void)from, (void)to, (void)before, (void)user;
  after[0] = HUGE_VAL;
  return 0;
}

/* The guard asks for v' > 5, as it is where the diode has been off. */
static void guards_and_failures(void) {
  sfdae_jump_function jumps[] = {fails, not_finite};
  const int statuses[] = {SFDAE_CALLBACK_STOPPED, SFDAE_NOT_FINITE};
  int k, calls = 0, mode;
  for (k = 0; k < 3; ++k) {
    sfdae_solver* solvers[2];
    sfdae_hybrid* hybrid = create_pair(rectifier, 3, NULL, "on", SFDAE_METHOD_BDF, solvers);
    sfdae_transition on = transition_of(0, 1, SFDAE_TRANSITION_ZERO, voltage);
    double t = 0, x[3] = {0.5, 0, 0};
    on.direction = 1;
    if (k < 2) on.jump = jumps[k];
    else on.guard = upward;
    on.user = &calls;
    CHECK_STATUS(sfdae_add_transition(hybrid, &on, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, x, NULL), SFDAE_OK);
    if (k == 2) {
      CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1, &t, x, NULL), SFDAE_OK); /* v' < 0 while it is off */
      CHECK(calls == 1);
      CHECK_STATUS(sfdae_get_current_mode(hybrid, &mode), SFDAE_OK);
      CHECK(mode == 0);
      NEAR(x[0], 0.5 * exp(-2), 1e-7);
      CHECK_STATUS(sfdae_set_parameter(solvers[0], "on", 0), SFDAE_OK); /* ends the integration */
    } else {
      CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1, &t, x, NULL), statuses[k]);
      CHECK(t > 0 && t < 0.25);
      NEAR(x[0], 0.5 * exp(-2 * t), 1e-7);
    }
    CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1.5, &t, x, NULL), SFDAE_NOT_STARTED);
    CHECK(has_message(hybrid, "sfdae_start_hybrid"));
    destroy(&hybrid, solvers, 2);
  }
}

static int stops_once(double t, int from, int to, const double* before, double* after, void* user) {
  int i;
  (void)t, (void)from, (void)to;
  for (i = 0; i < 3; ++i) after[i] = before[i];
  return sfdae_request_stop_hybrid((sfdae_hybrid*)user);
}

/* Two capacitors at the same voltage are joined: a stop that is requested while values jump ends the call, which can be
 * repeated. */
static void stops_at_a_transition(void) {
  double C[] = {1, 3, 0};
  sfdae_solver* solvers[2];
  sfdae_hybrid* hybrid = create_pair(joined, 3, C, "closed", SFDAE_METHOD_BDF, solvers);
  sfdae_transition close = transition_of(0, 1, SFDAE_TRANSITION_TIME, NULL);
  double t = 0, x[3] = {2, 2, 0};
  int mode = -1;
  close.time = 1;
  close.jump = stops_once;
  close.user = hybrid;
  CHECK_STATUS(sfdae_add_transition(hybrid, &close, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 2, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_set_events(solvers[0], 1, voltage, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solvers[0]), "transitions are its events") != NULL);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 2, &t, x, NULL), SFDAE_STOPPED);
  CHECK(t == 1);
  NEAR(x[0], 2, 1e-12);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 2, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_current_mode(hybrid, &mode), SFDAE_OK);
  CHECK(t == 2 && mode == 1);
  NEAR(x[1], 2, 1e-12);
  destroy(&hybrid, solvers, 2);
}

static void failures_name_the_mode(void) {
  double C[] = {1, 3, 0};
  sfdae_solver *wide = create(joined, 3, C, SFDAE_METHOD_BDF), *same = create(joined, 3, C, SFDAE_METHOD_BDF),
               *narrow = create(flight, 2, NULL, SFDAE_METHOD_BDF);
  sfdae_transition t = transition_of(0, 5, SFDAE_TRANSITION_CONDITION, height);
  sfdae_hybrid *hybrid = NULL, *other = NULL;
  sfdae_mode mode;
  double x[3] = {0, 0, 0}, time = 0;
  char text[2000];
  size_t needed = 0;
  CHECK_STATUS(sfdae_create_hybrid(NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_create_hybrid(&other), SFDAE_OK);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, x, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "there are no modes"));
  CHECK_STATUS(sfdae_add_mode(hybrid, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_add_mode(hybrid, wide, "open", NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&wide), SFDAE_BUSY);
  CHECK_STATUS(sfdae_add_mode(hybrid, wide, "again", NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_add_mode(other, wide, "again", NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(other, "a mode of a hybrid system already"));
  CHECK_STATUS(sfdae_add_mode(hybrid, narrow, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "has 2 unknowns, but those of the other modes have 3"));
  CHECK_STATUS(sfdae_add_mode(hybrid, same, "open", NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "mode 0 has the name \"open\" already"));
  CHECK_STATUS(sfdae_set_events(narrow, 1, height, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_add_mode(other, narrow, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(other, "has events"));

  CHECK_STATUS(sfdae_add_transition(hybrid, &t, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "to = 5; there are the modes 0 ... 0"));
  t = transition_of(-1, 0, SFDAE_TRANSITION_CONDITION, height);
  CHECK_STATUS(sfdae_add_transition(hybrid, &t, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "from = -1"));
  t = transition_of(0, 0, 7, height);
  CHECK_STATUS(sfdae_add_transition(hybrid, &t, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "kind = 7"));
  t = transition_of(0, 0, SFDAE_TRANSITION_ZERO, NULL);
  CHECK_STATUS(sfdae_add_transition(hybrid, &t, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "function is NULL"));
  t = transition_of(0, 0, SFDAE_TRANSITION_ZERO, height);
  t.direction = 2;
  CHECK_STATUS(sfdae_add_transition(hybrid, &t, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "direction = 2"));
  t = transition_of(0, 0, SFDAE_TRANSITION_TIME, NULL);
  t.time = HUGE_VAL;
  CHECK_STATUS(sfdae_add_transition(hybrid, &t, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "time is inf"));
  t.size = 0;
  CHECK_STATUS(sfdae_add_transition(hybrid, &t, NULL), SFDAE_ILLEGAL_ARGUMENT);

  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1, &time, x, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 1, 0, 1, x, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "mode = 1; there are the modes 0 ... 0"));
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 1, 1, x, NULL), SFDAE_ILLEGAL_ARGUMENT);
  x[2] = HUGE_VAL;
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, x, NULL), SFDAE_ILLEGAL_ARGUMENT);
  x[2] = 0;
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 0, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, -1, &time, x, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(has_message(hybrid, "tout = -1 lies before t = 0"));
  CHECK_STATUS(sfdae_request_stop_hybrid(hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1, &time, x, NULL), SFDAE_STOPPED);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1, &time, x, NULL), SFDAE_OK);
  CHECK(time == 1);
  sfdae_mode_init(&mode, sizeof mode);
  CHECK_STATUS(sfdae_get_mode(hybrid, 3, &mode), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_report_hybrid(hybrid, text, sizeof text, &needed), SFDAE_OK);
  CHECK(needed == strlen(text) + 1);
  CHECK(strstr(text, "mode 0 (open)") != NULL);
  CHECK_STATUS(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy_hybrid(&other), SFDAE_OK);
  sfdae_destroy(&wide);
  sfdae_destroy(&same);
  sfdae_destroy(&narrow);
  CHECK(wide == NULL && same == NULL && narrow == NULL);
}

/* x' = x > y ? -2 : 2, y' = y > x ? -3 : 1.5 */
static int corner(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                  sfdae_expression* F, void* user) {
  const int right = *(const int*)user;
  (void)record, (void)t, (void)x;
  F[0] = sfdae_add(xdot[0], sfdae_number(right ? 2 : -2));
  F[1] = sfdae_add(xdot[1], sfdae_number(right ? -1.5 : 3));
  return 0;
}

static int diagonal(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    sfdae_expression* g, void* user) {
  (void)record, (void)t, (void)xdot;
  if (user != NULL) return 7;
  g[0] = sfdae_subtract(x[0], x[1]);
  return 0;
}

static void slides_by_a_switch(void) {
  int k, mode = -1, sides[] = {0, 1};
  double t = 0, x[] = {1.5, 1}, xdot[2], before[2], after[2];
  size_t length = 0;
  sfdae_nonlinear_problem problem;
  sfdae_solver* solvers[2];
  sfdae_passage passage;
  sfdae_hybrid* hybrid = NULL;
  CHECK_STATUS(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  CHECK_STATUS(sfdae_add_switch(hybrid, 0, 1, diagonal, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.equations = corner;
  for (k = 0; k < 2; ++k) {
    problem.user = &sides[k];
    CHECK_STATUS(sfdae_create_nonlinear(&solvers[k], &problem, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_add_mode(hybrid, solvers[k], NULL, NULL), SFDAE_OK);
  }
  CHECK_STATUS(sfdae_add_switch(hybrid, 0, 1, diagonal, &k, NULL, &mode), SFDAE_CALLBACK_FAILED);
  CHECK(mode == -1);
  CHECK_STATUS(sfdae_add_switch(hybrid, 0, 1, diagonal, NULL, "along", &mode), SFDAE_OK);
  CHECK(mode == 2);
  CHECK_STATUS(sfdae_start_hybrid(hybrid, 1, 0, 1, x, xdot), SFDAE_OK);
  CHECK_STATUS(sfdae_advance_hybrid(hybrid, 1, &t, x, xdot), SFDAE_OK);
  CHECK(fabs(x[0] - 217.0 / 238) < 1e-5 && fabs(x[1] - 217.0 / 238) < 1e-5);
  CHECK(fabs(xdot[0] + 6.0 / 17) < 1e-5);
  sfdae_passage_init(&passage, sizeof passage);
  CHECK_STATUS(sfdae_get_passage(hybrid, 0, &passage), SFDAE_OK);
  CHECK(passage.from == 1 && passage.to == 2 && passage.transition == 1);
  CHECK_STATUS(sfdae_get_passage_values(hybrid, before, after, NULL), SFDAE_OK);
  CHECK(fabs(before[0] - 17.0 / 14) < 1e-5 && fabs(after[1] - 17.0 / 14) < 1e-5);
  CHECK_STATUS(sfdae_get_hybrid_checkpoint_length(hybrid, &length), SFDAE_OK);
  CHECK_STATUS(sfdae_set_parameter(solvers[0], "rate", 1), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_destroy(&solvers[0]), SFDAE_BUSY);
  CHECK_STATUS(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
  for (k = 0; k < 2; ++k) CHECK_STATUS(sfdae_destroy(&solvers[k]), SFDAE_OK);
}

int main(void) {
  double capacitors[] = {1, 3, 1}, clutch[] = {1, 2, 0};
  join(capacitors, 2 * exp(1), 0, 0.5, 1.5);
  join(clutch, 0.2, 1, 2.2 / 3, 0.2 - 2.2 / 3);
  modes_of_different_index(SFDAE_METHOD_BDF);
  modes_of_different_index(SFDAE_METHOD_RADAU);
  transitions_one_by_one();
  checkpoints();
  bounces_accumulate(0.5);
  bounces_accumulate(0.8);
  bounces_accumulate(0.95);
  chattering_ends(-0.5);
  chattering_ends(0);
  slides_in_a_mode_of_its_own(1.5, 1);
  slides_in_a_mode_of_its_own(0.5, 1);
  slides_by_a_switch();
  guards_and_failures();
  stops_at_a_transition();
  failures_name_the_mode();
  return failures > 0;
}
