/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Consistent initial values: nearest, weighted, fixed, accepted; what is reported about them; x'.
 *
 *     x1' = x3,   x2' = -x2,   0 = x1 + 2 x2 - g(t),   g = sin 2t       mu = 1, d = 1, a = 2
 * The derivative of the constraint gives x3 = 2 x2 + g'. The consistent points at t are a line,
 *     x(c) = (g - 2c, c, g' + 2c),   and x' = (x3, -x2, g'' - 2 x2).
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

static double g(double t, int order) { return pow(2, order) * sin(2 * t + order * acos(0.0)); }

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = matrix[4] = 1;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) {
    matrix[0 + 3 * 2] = 1;
    matrix[1 + 3 * 1] = -1;
    matrix[2 + 3 * 0] = 1;
    matrix[2 + 3 * 1] = 2;
  }
  return 0;
}

static int f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[2] = -g(t, order);
  return 0;
}

/* The same without derivatives. */
static int f_alone(double t, int order, double* vector, void* user) {
  return order ? SFDAE_ORDER_NOT_AVAILABLE : f(t, order, vector, user);
}

static sfdae_options defaults(void) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  return options;
}

static sfdae_solver* create_with(const sfdae_options* options, sfdae_vector_function f_or_f_alone) {
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 3;
  problem.E = E;
  problem.A = A;
  problem.f = f_or_f_alone;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, options), SFDAE_OK);
  return solver;
}

static sfdae_solver* create(const sfdae_options* options) { return create_with(options, f); }

static const double guess[3] = {0.3, -0.8, 1.7};
static const double t0 = 0.4;
static const double rounding = 1000 * DBL_EPSILON; /* a few dozen operations on numbers of size 1 to 10 */

static int near(double a, double b) { return fabs(a - b) <= rounding; }

static int is_point(const double* x, double t, double c) {
  return near(x[0], g(t, 0) - 2 * c) && near(x[1], c) && near(x[2], g(t, 1) + 2 * c);
}

static int is_derivative(const double* xdot, const double* x, double t) {
  return near(xdot[0], x[2]) && near(xdot[1], -x[1]) && near(xdot[2], g(t, 2) - 2 * x[1]);
}

/* The point x(c) where sum ((x_i - guess_i) / w_i)^2 is smallest. */
static double nearest(double t, const double* y, const double* w) {
  const double w1 = 1 / (w[0] * w[0]), w2 = 1 / (w[1] * w[1]), w3 = 1 / (w[2] * w[2]);
  return (2 * w1 * (g(t, 0) - y[0]) + w2 * y[1] + 2 * w3 * (y[2] - g(t, 1))) / (4 * w1 + w2 + 4 * w3);
}

/* Distance from y to the consistent points. */
static double distance(double t, const double* y) {
  static const double ones[3] = {1, 1, 1};
  const double c = nearest(t, y, ones);
  const double d1 = y[0] - g(t, 0) + 2 * c, d2 = y[1] - c, d3 = y[2] - g(t, 1) - 2 * c;
  return sqrt(d1 * d1 + d2 * d2 + d3 * d3);
}

/* What the report says about the last change from y to x. With rows a_i of A2 of norm 1 the residuals a_i (y - y*),
 * y* the consistent point nearest to y, are at most |y - y*|; the two rows [1 2 0] and [0 -2 1] or combinations of
 * them are far enough from parallel that one is at least a tenth of it. */
static void check_report(sfdae_solver* solver, double t, const double* y, const double* x) {
  sfdae_initial_report report;
  double change = 0;
  int component = -1, j;
  sfdae_initial_report_init(&report, sizeof report);
  CHECK_STATUS(sfdae_get_initial_report(solver, &report), SFDAE_OK);
  for (j = 0; j < 3; j++)
    if (fabs(x[j] - y[j]) > change) change = fabs(x[j] - y[j]), component = j;
  CHECK(report.t == t);
  CHECK(report.residual_before <= distance(t, y) * (1 + rounding) + rounding);
  CHECK(report.residual_before >= distance(t, y) / 10 - rounding);
  CHECK(report.residual_after <= distance(t, x) + rounding);
  CHECK(report.residual_after >= distance(t, x) / 10 - rounding);
  CHECK(near(report.largest_change, change));
  CHECK(report.component == component || change <= rounding);
}

/* start and make_consistent do the same to x and xdot. */
static void becomes(int line, const sfdae_options* options, const double* y, double c, int expected) {
  int start;
  for (start = 0; start <= 1; start++) {
    sfdae_solver* solver = create(options);
    double x[3], xdot[3];
    const int failures_before = failures;
    memcpy(x, y, sizeof x);
    check_status(__FILE__, line, "start or make_consistent",
                 start ? sfdae_start(solver, t0, 2, x, xdot) : sfdae_make_consistent(solver, t0, x, xdot), expected);
    CHECK(is_point(x, t0, c));
    CHECK(is_derivative(xdot, x, t0));
    check_report(solver, t0, y, x);
    sfdae_destroy(&solver);
    if (failures > failures_before) fprintf(stderr, "  ... called in line %d\n", line);
  }
}
#define BECOMES(options, y, c) becomes(__LINE__, (options), (y), (c), SFDAE_OK)

static void is_refused(int line, const sfdae_options* options, const double* y, int expected) {
  int start;
  for (start = 0; start <= 1; start++) {
    sfdae_solver* solver = create(options);
    double x[3], xdot[3] = {-77, -77, -77};
    memcpy(x, y, sizeof x);
    check_status(__FILE__, line, "start or make_consistent",
                 start ? sfdae_start(solver, t0, 2, x, xdot) : sfdae_make_consistent(solver, t0, x, xdot), expected);
    CHECK(memcmp(x, y, sizeof x) == 0 && xdot[0] == -77 && xdot[1] == -77 && xdot[2] == -77);
    CHECK(sfdae_message(solver)[0] != 0);
    sfdae_destroy(&solver);
  }
}
#define REFUSED(options, y, expected) is_refused(__LINE__, (options), (y), (expected))

/* x1 and x2 are differentiated: their distance, measured in tolerances, is what counts, and x3 follows. */
static double nearest_differentiated(double t, const double* y) {
  const double free_x3 = 1e100;
  double tolerances[3];
  tolerances[0] = 1e-6 * fabs(y[0]) + 1e-6;
  tolerances[1] = 1e-6 * fabs(y[1]) + 1e-6;
  tolerances[2] = free_x3;
  return nearest(t, y, tolerances);
}

static void nearest_point_is_taken(void) {
  becomes(__LINE__, NULL, guess, nearest_differentiated(t0, guess), SFDAE_VALUES_CHANGED);
}

/* x1 and x2 fit, x3 is not known: it adapts, and nothing else changes. */
static void what_is_differentiated_stays(void) {
  static const double unknown[3] = {0, -40, 1e6};
  int k;
  for (k = 0; k < 3; k++) {
    double y[3];
    y[0] = g(t0, 0) - 2 * 0.7;
    y[1] = 0.7;
    y[2] = unknown[k];
    BECOMES(NULL, y, 0.7);
  }
}

/* The largest change in words, once: which unknown, from where, to where. */
static void changes_are_said_in_words(void) {
  sfdae_solver* solver = create(NULL);
  double t, x[3];
  x[0] = g(t0, 0) - 2 * 0.7;
  x[1] = 0.7 + 1e-7; /* below the tolerances */
  x[2] = 0;
  CHECK_STATUS(sfdae_start(solver, t0, 2, x, NULL), SFDAE_OK);
  CHECK(sfdae_message(solver)[0] == 0);
  x[0] = g(t0, 0);
  x[1] = 0.25;
  CHECK_STATUS(sfdae_start(solver, t0, 2, x, NULL), SFDAE_VALUES_CHANGED);
  /* The constraint is x1 + 2 x2: in equal tolerances x2 has to change twice as much as x1. */
  CHECK(strstr(sfdae_message(solver), "x[1] changed from 0.25 to ") != NULL);
  CHECK_STATUS(sfdae_advance(solver, 0.5, &t, x, NULL), SFDAE_OK);
  CHECK(sfdae_message(solver)[0] == 0);
  sfdae_destroy(&solver);
}

static void weights_say_what_may_change(void) {
  static const double weights[][3] = {{1, 1, 1}, {0.1, 1, 10}, {5, 0.01, 1}, {1, 1000, 0.1}};
  size_t k;
  for (k = 0; k < sizeof weights / sizeof weights[0]; k++) {
    sfdae_options options = defaults();
    options.initial_weights = weights[k];
    BECOMES(&options, guess, nearest(t0, guess, weights[k]));
  }
}

static void fixed_components_stay(void) {
  static const int first[3] = {1, 0, 0}, second[3] = {0, 1, 0}, third[3] = {0, 0, 1}, none[3] = {0, 0, 0};
  sfdae_options options = defaults();
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = first;
  BECOMES(&options, guess, (g(t0, 0) - guess[0]) / 2);
  options.fixed = second;
  BECOMES(&options, guess, guess[1]);
  options.fixed = third;
  BECOMES(&options, guess, (guess[2] - g(t0, 1)) / 2);
  options.fixed = none;
  BECOMES(&options, guess, nearest_differentiated(t0, guess));
}

static void fixed_components_stay_exactly(void) {
  static const int second[3] = {0, 1, 0};
  sfdae_options options = defaults();
  sfdae_solver* solver;
  double x[3];
  memcpy(x, guess, sizeof x);
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = second;
  solver = create(&options);
  CHECK_STATUS(sfdae_make_consistent(solver, t0, x, NULL), SFDAE_OK);
  CHECK(x[1] == guess[1]);
  sfdae_destroy(&solver);
}

static void contradictory_fixed_components_are_refused(void) {
  static const int two[3] = {1, 1, 0}, all[3] = {1, 1, 1};
  sfdae_options options = defaults();
  double fine[3];
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = two;
  REFUSED(&options, guess, SFDAE_FIXED_VALUES);
  options.fixed = all;
  REFUSED(&options, guess, SFDAE_FIXED_VALUES);

  /* Too many, but they fit. */
  fine[0] = g(t0, 0) - 2 * 0.7;
  fine[1] = 0.7;
  fine[2] = g(t0, 1) + 2 * 0.7;
  BECOMES(&options, fine, 0.7);
  options.fixed = two;
  fine[2] = 100;
  BECOMES(&options, fine, 0.7);
}

static void accepted_values_do_not_change(void) {
  sfdae_options options = defaults();
  sfdae_solver* solver;
  double x[3], before[3], xdot[3];
  options.initial_values = SFDAE_INITIAL_ACCEPT;
  x[0] = g(t0, 0) - 2 * 0.7;
  x[1] = 0.7;
  x[2] = g(t0, 1) + 2 * 0.7 + 1e-9; /* below the tolerances, 1e-6 */
  memcpy(before, x, sizeof x);
  solver = create(&options);
  CHECK_STATUS(sfdae_start(solver, t0, 2, x, xdot), SFDAE_OK);
  CHECK(memcmp(x, before, sizeof x) == 0);
  check_report(solver, t0, before, x);
  sfdae_destroy(&solver);
  REFUSED(&options, guess, SFDAE_INCONSISTENT_VALUES);
  x[2] += 1e-3;
  REFUSED(&options, x, SFDAE_INCONSISTENT_VALUES);
}

/* Violations that rounding explains are no reason to move a consistent point. */
static void consistent_values_stay(void) {
  sfdae_solver* solver = create(NULL);
  double x[3], before[3], xdot[3];
  x[0] = g(t0, 0) - 2 * 0.7;
  x[1] = 0.7;
  x[2] = g(t0, 1) + 2 * 0.7;
  memcpy(before, x, sizeof x);
  CHECK_STATUS(sfdae_start(solver, t0, 2, x, xdot), SFDAE_OK);
  CHECK(near(x[0], before[0]) && near(x[1], before[1]) && near(x[2], before[2]));
  CHECK(is_derivative(xdot, x, t0));
  CHECK_STATUS(sfdae_make_consistent(solver, t0, x, NULL), SFDAE_OK); /* idempotent */
  CHECK(near(x[0], before[0]) && near(x[1], before[1]) && near(x[2], before[2]));
  sfdae_destroy(&solver);
}

/* Without derivatives beyond those that the analysis needs, x3' comes from differences. */
static void derivative_says_where_it_comes_from(void) {
  sfdae_options options = defaults();
  sfdae_initial_report report;
  sfdae_solver* solver = create(&options);
  double x[3], xdot[3];
  sfdae_initial_report_init(&report, sizeof report);
  CHECK(sfdae_get_initial_report(solver, &report) < 0);
  memcpy(x, guess, sizeof x);
  CHECK_STATUS(sfdae_start(solver, t0, 2, x, xdot), SFDAE_VALUES_CHANGED);
  CHECK_STATUS(sfdae_get_initial_report(solver, &report), SFDAE_OK);
  CHECK(report.derivative_exact == 1);
  sfdae_destroy(&solver);

  options.max_index = 1; /* mu + 1 = 2 exceeds it */
  solver = create(&options);
  memcpy(x, guess, sizeof x);
  CHECK_STATUS(sfdae_start(solver, t0, 2, x, xdot), SFDAE_VALUES_CHANGED);
  CHECK_STATUS(sfdae_get_initial_report(solver, &report), SFDAE_OK);
  CHECK(report.derivative_exact == 0);
  /* Differences of functions of size 10 on a scale of 1: eps^(1/2) at worst, with a factor 100. */
  CHECK(fabs(xdot[0] - x[2]) <= 1000 * sqrt(DBL_EPSILON) && fabs(xdot[1] + x[1]) <= 1000 * sqrt(DBL_EPSILON));
  CHECK(fabs(xdot[2] - (g(t0, 2) - 2 * x[1])) <= 1000 * sqrt(DBL_EPSILON));
  sfdae_destroy(&solver);

  options.max_index = 5;
  options.difference_derivatives = 1;
  solver = create_with(&options, f_alone);
  memcpy(x, guess, sizeof x);
  CHECK_STATUS(sfdae_start(solver, t0, 2, x, xdot), SFDAE_VALUES_CHANGED);
  CHECK(fabs(x[0] + 2 * x[1] - g(t0, 0)) <= rounding);
  CHECK(fabs(x[2] - 2 * x[1] - g(t0, 1)) <= 1e-6);
  CHECK(fabs(xdot[2] - (g(t0, 2) - 2 * x[1])) <= 1e-3);
  sfdae_destroy(&solver);
}

static void make_consistent_leaves_the_point_reached(void) {
  sfdae_solver* solver = create(NULL);
  double t, x[3] = {0, 1, 0}, y[3], c;
  CHECK_STATUS(sfdae_start(solver, 0, 2, x, NULL), SFDAE_VALUES_CHANGED);
  c = x[1];
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  memcpy(y, guess, sizeof y);
  CHECK_STATUS(sfdae_make_consistent(solver, 0.3, y, NULL), SFDAE_VALUES_CHANGED);
  CHECK(is_point(y, 0.3, y[1]));
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
  CHECK(t == 2 && fabs(x[1] - c * exp(-2)) <= 10 * (1e-6 * fabs(c * exp(-2)) + 1e-6));
  CHECK(is_point(x, 2, x[1]));
  sfdae_destroy(&solver);
}

/* ---- Free components --------------------------------------------------------------------------------- */

/* x1' = -x1 + x2, x2 is free. */
static int control_E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = 1;
  return 0;
}
static int control_A(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = -1, matrix[1] = 1;
  return 0;
}
static int input(double t, int order, double* values, void* user) {
  (void)user;
  CHECK(order == 0);
  values[0] = cos(t);
  return 0;
}

static sfdae_solver* create_control(int prescribed) {
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = 1;
  problem.num_unknowns = 2;
  problem.E = control_E;
  problem.A = control_A;
  problem.prescribed = &prescribed;
  problem.prescribed_values = input;
  problem.num_prescribed = prescribed >= 0 ? 1 : 0;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  return solver;
}

/* x(0) = (3, 2) is consistent; x' of minimum norm leaves x2 where it is, and so does the integration. */
static void free_components_are_held(void) {
  sfdae_solver* solver = create_control(-1);
  double t, x[2] = {3, 2}, xdot[2];
  CHECK(sfdae_start(solver, 0, 1, x, xdot) >= 0);
  CHECK(near(x[0], 3) && near(x[1], 2) && near(xdot[0], -1) && near(xdot[1], 0));
  CHECK(sfdae_advance(solver, 1, &t, x, xdot) >= 0);
  CHECK(near(x[1], 2) && near(xdot[1], 0));
  CHECK(fabs(x[0] - (2 + exp(-1))) <= 10 * (1e-6 * x[0] + 1e-6));
  sfdae_destroy(&solver);
}

/* With x2 = cos t:  x1 = (cos t + sin t) / 2 + c e^-t. Only x2 changes to become consistent. */
static void prescribed_components_follow_their_values(void) {
  sfdae_solver* solver = create_control(1);
  double t, x[2] = {3, 2}, xdot[2];
  CHECK(sfdae_start(solver, 0, 1, x, xdot) >= 0);
  CHECK(near(x[0], 3) && near(x[1], 1) && near(xdot[0], -2));
  CHECK(fabs(xdot[1]) <= 1000 * sqrt(DBL_EPSILON)); /* no derivative of the values is asked for */
  CHECK(sfdae_advance(solver, 1, &t, x, NULL) >= 0);
  CHECK(near(x[1], cos(1)));
  CHECK(fabs(x[0] - ((cos(1) + sin(1)) / 2 + 2.5 * exp(-1))) <= 10 * (1e-6 * x[0] + 1e-6));
  sfdae_destroy(&solver);
}

/* x1 has its own equation: prescribing it does not determine x2 in x1' = -x1 + x2 without a derivative. */
static void prescriptions_that_do_not_fit_are_refused(void) {
  sfdae_solver* solver = create_control(0);
  double x[2] = {3, 2}, xdot[2] = {-77, -77};
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_PRESCRIPTION_SINGULAR);
  CHECK(x[0] == 3 && x[1] == 2 && xdot[0] == -77 && xdot[1] == -77);
  CHECK(sfdae_message(solver)[0] != 0);
  sfdae_destroy(&solver);
}

/* ---- Redundant equations -------------------------------------------------------------------------------- */

/* x1' = 0 and x1 = 1 + slope t: contradictory unless slope = 0. */
static int law_E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = 1;
  return 0;
}
static int law_A(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[1] = -1;
  return 0;
}
static int law_f(double t, int order, double* vector, void* user) {
  const double slope = *(const double*)user;
  if (order == 0) vector[1] = 1 + slope * t;
  if (order == 1) vector[1] = slope;
  return 0;
}

static void contradictions_are_refused_or_ignored(void) {
  sfdae_linear_problem problem;
  sfdae_options options = defaults();
  sfdae_solver* solver = NULL;
  double slope = 0, t, x[1] = {5}, residual;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = 2;
  problem.num_unknowns = 1;
  problem.E = law_E;
  problem.A = law_A;
  problem.f = law_f;
  problem.user = &slope;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_VALUES_CHANGED);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(near(x[0], 1));

  slope = 0.25;
  x[0] = 5;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_INCONSISTENT_EQUATIONS);
  CHECK(x[0] == 5 && sfdae_message(solver)[0] != 0);
  CHECK_STATUS(sfdae_make_consistent(solver, 0, x, NULL), SFDAE_INCONSISTENT_EQUATIONS);
  CHECK(x[0] == 5);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0, NULL, NULL, NULL, NULL, NULL, &residual), SFDAE_OK);
  CHECK(residual > 0.01 && residual < 0.251);

  options.ignore_inconsistency = 1;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  /* x(0) = 1 is consistent; both warnings apply, and the message has both. */
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_INCONSISTENCY_IGNORED);
  CHECK(strstr(sfdae_message(solver), "contradict") && strstr(sfdae_message(solver), "x[0] changed from 5 to 1 "));
  CHECK(near(x[0], 1));
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_INCONSISTENCY_IGNORED);
  CHECK(t == 1 && near(x[0], 1.25)); /* the constraint holds */
  CHECK(sfdae_message(solver)[0] != 0);
  sfdae_destroy(&solver);
}

int main(void) {
  nearest_point_is_taken();
  what_is_differentiated_stays();
  changes_are_said_in_words();
  weights_say_what_may_change();
  fixed_components_stay();
  fixed_components_stay_exactly();
  contradictory_fixed_components_are_refused();
  accepted_values_do_not_change();
  consistent_values_stay();
  derivative_says_where_it_comes_from();
  make_consistent_leaves_the_point_reached();
  free_components_are_held();
  prescribed_components_follow_their_values();
  prescriptions_that_do_not_fit_are_refused();
  contradictions_are_refused_or_ignored();
  return failures != 0;
}
