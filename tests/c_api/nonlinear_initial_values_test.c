/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Consistent values of the pushed pendulum: nearest, with fixed components, weighted, or taken as given; analysis from
 * guesses that are not consistent.
 *
 * At t = 0 the force is 0 and the constraints are  x1^2 + x2^2 = 1,  x1 x3 + x2 x4 = 0,
 * x3^2 + x4^2 - 2 x5 + x1 x6 - g x2 = 0.
 */
#include <stdio.h>

#include "nonlinear_pendulum.h"

static sfdae_nonlinear_problem form(int k) { return k == 0 ? recorded_pendulum() : differentiated_pendulum(); }

/* Weights of the same size make the change of the positions that to the nearest point of the circle, as long as
 * velocities and forces weigh little. */
static void the_nearest_point_is_found(void) {
  static const double weights[N] = {1, 1, 1e6, 1e6, 1e6, 1e6};
  int k;
  for (k = 0; k < 2; k++) {
    sfdae_nonlinear_problem problem = form(k);
    sfdae_options options = default_options();
    sfdae_solver* solver;
    sfdae_initial_report report;
    double x[N] = {0.36, -1.02, 0.5, 0.1, 0.7, 0}, xdot[N];
    const double length = sqrt(x[0] * x[0] + x[1] * x[1]), x1 = x[0] / length, x2 = x[1] / length;
    options.initial_weights = weights;
    solver = CREATE(&problem, &options);
    CHECK_STATUS(sfdae_make_consistent(solver, 0, x, xdot), SFDAE_OK);
    CHECK(violation(x) <= 1e-12 && fabs(x[5]) <= 1e-12);
    CHECK(fabs(x[0] - x1) <= 1e-6 && fabs(x[1] - x2) <= 1e-6);
    CHECK(fabs(xdot[0] - x[2]) <= 1e-12 && fabs(xdot[1] - x[3]) <= 1e-12);
    CHECK(fabs(xdot[2] + 2 * x[0] * x[4] - x[5]) <= 1e-12 && fabs(xdot[3] + 2 * x[1] * x[4] + gravity) <= 1e-12);
    sfdae_initial_report_init(&report, sizeof report);
    CHECK_STATUS(sfdae_get_initial_report(solver, &report), SFDAE_OK);
    CHECK(report.t == 0 && report.residual_before > 1e-3 && report.residual_after <= 1e-11);
    CHECK(report.largest_change > 0.01 && report.component >= 0 && report.component < N);
    sfdae_destroy(&solver);
  }
}

static void values_that_are_consistent_stay(void) {
  int k, i;
  for (k = 0; k < 2; k++) {
    sfdae_nonlinear_problem problem = form(k);
    sfdae_solver* solver = CREATE(&problem, NULL);
    double x[N], before[N], xdot[N], ahead[N], behind[N];
    const double h = 1e-5;
    exact(0.7, x);
    memcpy(before, x, sizeof x);
    CHECK_STATUS(sfdae_make_consistent(solver, 0.7, x, xdot), SFDAE_OK);
    for (i = 0; i < N; i++) CHECK(fabs(x[i] - before[i]) <= 1e-13);
    exact(0.7 + h, ahead);
    exact(0.7 - h, behind);
    for (i = 0; i < 4; i++) CHECK(fabs(xdot[i] - (ahead[i] - behind[i]) / (2 * h)) <= 1e-8);
    sfdae_destroy(&solver);
  }
}

/* Position x1 and velocity x3 fix the rest: x2 = -sqrt(1 - x1^2), x4 = -x1 x3 / x2. They stay in every bit, whatever
 * the rounding errors of the search are. */
static void many_fixed_components_stay(void) {
  static const int fixed[N] = {1, 0, 1, 0, 0, 0};
  int k, j;
  for (k = 0; k < 2; k++) {
    sfdae_nonlinear_problem problem = form(k);
    sfdae_options options = default_options();
    sfdae_solver* solver;
    options.initial_values = SFDAE_INITIAL_FIXED;
    options.fixed = fixed;
    solver = CREATE(&problem, &options);
    for (j = 1; j <= 50; j++) {
      const double x1 = 0.6 * sin(j), x3 = 0.7 * cos(3.0 * j), x2 = -sqrt(1 - x1 * x1);
      double x[N] = {0};
      x[0] = x1, x[1] = x2 - 0.1 * cos(5.0 * j), x[2] = x3;
      CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
      CHECK(x[0] == x1 && x[2] == x3 && fabs(x[1] - x2) <= 1e-13 && fabs(x[3] + x1 * x3 / x2) <= 1e-13);
    }
    /* There is no such point, though consistent ones are known from before. */
    for (j = 0; j < 4; j++) {
      double x[N] = {0}, before[N];
      x[0] = 1.001 + 0.5 * j, x[1] = -0.5, x[2] = 0.2;
      memcpy(before, x, sizeof x);
      CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_NO_CONSISTENT_VALUES);
      CHECK(memcmp(x, before, sizeof x) == 0 && strstr(sfdae_message(solver), "fix fewer components") != NULL);
    }
    sfdae_destroy(&solver);
  }
}

/* The same for one start, then what contradicts it. */
static void fixed_components_stay(void) {
  static const int fixed[N] = {1, 0, 1, 0, 0, 0};
  int k;
  for (k = 0; k < 2; k++) {
    sfdae_nonlinear_problem problem = form(k);
    sfdae_options options = default_options();
    sfdae_solver* solver;
    double x[N] = {0.6, -0.7, 0.5, 0, 0, 0}, t = unset, before[N];
    static const int all[N] = {1, 1, 1, 1, 1, 1};
    options.initial_values = SFDAE_INITIAL_FIXED;
    options.fixed = fixed;
    solver = CREATE(&problem, &options);
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
    CHECK(x[0] == 0.6 && x[2] == 0.5 && fabs(x[1] + 0.8) <= 1e-13 && fabs(x[3] - 0.375) <= 1e-13);
    CHECK(violation(x) <= 1e-12);
    CHECK_STATUS(sfdae_advance(solver, 0.1, &t, x, NULL), SFDAE_OK);

    /* What contradicts the constraints is refused. */
    options.fixed = all;
    CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
    x[0] = 0.5;
    memcpy(before, x, sizeof x);
    CHECK(sfdae_start(solver, 0, 1, x, NULL) < 0);
    CHECK(memcmp(x, before, sizeof x) == 0 && strlen(sfdae_message(solver)) > 10);
    sfdae_destroy(&solver);
  }
}

static void given_values_are_taken_or_refused(void) {
  int k, i;
  for (k = 0; k < 2; k++) {
    sfdae_nonlinear_problem problem = form(k);
    sfdae_options options = default_options();
    sfdae_solver* solver;
    double x[N], before[N], t = unset;
    options.initial_values = SFDAE_INITIAL_ACCEPT;
    solver = CREATE(&problem, &options);
    exact(0, x);
    for (i = 0; i < N; i++) x[i] += 1e-9;
    memcpy(before, x, sizeof x);
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
    CHECK(memcmp(x, before, sizeof x) == 0);
    CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
    CHECK(accurate(t, x, 1e-6));
    for (i = 0; i < 5; i++) {
      exact(0, x);
      x[i] += 0.01;
      memcpy(before, x, sizeof x);
      CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_INCONSISTENT_VALUES);
      CHECK(memcmp(x, before, sizeof x) == 0);
    }
    sfdae_destroy(&solver);
  }
}

/* 0 < |w| < infinity leave a point on the constraints; where a weight is small, its component changes little. */
static void weights_count(void) {
  int k;
  for (k = 0; k < 2; k++) {
    sfdae_nonlinear_problem problem = form(k);
    double weights[N] = {1, 1, 1, 1, 1, 1}, x[N], change[2];
    int light;
    for (light = 0; light < 2; light++) {
      sfdae_options options = default_options();
      sfdae_solver* solver;
      weights[0] = light ? 1e-4 : 1;
      options.initial_weights = weights;
      solver = CREATE(&problem, &options);
      exact(0, x);
      x[0] = 0.2;
      CHECK_STATUS(sfdae_make_consistent(solver, 0, x, NULL), SFDAE_OK);
      CHECK(violation(x) <= 1e-12);
      change[light] = fabs(x[0] - 0.2);
      sfdae_destroy(&solver);
    }
    CHECK(change[1] < 1e-3 * change[0] + 1e-12);
  }
}

/* The analysis goes to the constraints first. The guess itself is left alone. */
static void guesses_need_not_be_consistent(void) {
  static const double sizes[] = {1e-6, 1e-3, 0.1, 0.3};
  int k, i, j;
  for (k = 0; k < 2; k++)
    for (i = 0; i < 4; i++) {
      sfdae_nonlinear_problem problem = form(k);
      sfdae_solver* solver = CREATE(&problem, NULL);
      sfdae_characteristics c;
      double x[N], before[N];
      sfdae_characteristics_init(&c, sizeof c);
      exact(0, x);
      for (j = 0; j < N; j++) x[j] += sizes[i] * cos(1.0 + 3 * j);
      memcpy(before, x, sizeof x);
      CHECK(sfdae_analyze_at(solver, 0, 1, x, &c) >= 0);
      CHECK(c.strangeness_index == 2 && c.differential == 2 && c.algebraic == 3 && c.undetermined == 1);
      CHECK(c.t == 0 && c.redundant == 0 && memcmp(x, before, sizeof x) == 0);
      sfdae_destroy(&solver);
    }
}

/* x1^2 + x2^2 + 1 = 0 */
static int no_solution(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                       const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  (void)record, (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[1]);
  F[1] = sfdae_add(sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1])), sfdae_number(1));
  return 0;
}

static void what_does_not_exist_is_not_found(void) {
  sfdae_nonlinear_problem problem = pendulum_problem();
  sfdae_solver* solver;
  double x[2] = {1, 2};
  problem.num_equations = problem.num_unknowns = 2;
  problem.num_prescribed = 0;
  problem.equations = no_solution;
  solver = CREATE(&problem, NULL);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_NO_CONSISTENT_VALUES);
  CHECK(x[0] == 1 && x[1] == 2 && strlen(sfdae_message(solver)) > 10);
  sfdae_destroy(&solver);
}

/* x'^2 = 1 */
static int square_of_slope(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                           const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  (void)record, (void)t, (void)x, (void)user;
  F[0] = sfdae_subtract(sfdae_multiply(xdot[0], xdot[0]), sfdae_number(1));
  return 0;
}

static sfdae_solver* create_square_of_slope(int xdot_is_guess) {
  sfdae_nonlinear_problem problem;
  sfdae_options options = default_options();
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 1;
  problem.equations = square_of_slope;
  options.xdot_is_guess = xdot_is_guess;
  return CREATE(&problem, &options);
}

/* Either branch, from start and make_consistent; refused guesses leave all as it was. */
static void slopes_are_guessed(void) {
  static const double signs[2] = {1, -1};
  int i;
  for (i = 0; i < 2; i++) {
    sfdae_solver* solver = create_square_of_slope(1);
    double t = unset, x[1] = {3}, xdot[1];
    xdot[0] = 0.7 * signs[i];
    CHECK_STATUS(sfdae_make_consistent(solver, 0, x, xdot), SFDAE_OK);
    CHECK(x[0] == 3 && fabs(xdot[0] - signs[i]) <= 1e-14);
    xdot[0] = -20 * signs[i];
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_OK);
    CHECK(x[0] == 3 && fabs(xdot[0] + signs[i]) <= 1e-14);
    CHECK_STATUS(sfdae_advance(solver, 1, &t, x, xdot), SFDAE_OK);
    CHECK(fabs(x[0] - 3 + signs[i]) <= 1e-5 && fabs(xdot[0] + signs[i]) <= 1e-5);
    xdot[0] = HUGE_VAL;
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
    CHECK(strstr(sfdae_message(solver), "xdot") != NULL);
    sfdae_destroy(&solver);
  }
}

/* A failed question does not hide why the last call failed; without such a failure it says what is wrong itself. */
static void questions_leave_explanations(void) {
  sfdae_solver* solver = create_square_of_slope(0);
  sfdae_characteristics c;
  char why[2000];
  int count = 0;
  double x[1] = {3};
  sfdae_characteristics_init(&c, sizeof c);
  CHECK_STATUS(sfdae_get_num_decisions(solver, &count), SFDAE_NOT_STARTED);
  CHECK(strstr(sfdae_message(solver), "first") != NULL);
  CHECK_STATUS(sfdae_get_num_decisions(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solver), "NULL") != NULL);
  CHECK_STATUS(sfdae_start(solver, 0, 0, x, NULL), SFDAE_ILLEGAL_ARGUMENT);
  strcpy(why, sfdae_message(solver));
  CHECK(strlen(why) > 10);
  CHECK_STATUS(sfdae_get_characteristics(solver, &c), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_num_decisions(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_projectors(solver, 0, NULL, NULL, NULL, NULL, NULL), SFDAE_NOT_STARTED);
  CHECK(strcmp(sfdae_message(solver), why) == 0);
  sfdae_destroy(&solver);
}

int main(void) {
  the_nearest_point_is_found();
  values_that_are_consistent_stay();
  fixed_components_stay();
  many_fixed_components_stay();
  given_values_are_taken_or_refused();
  weights_count();
  guesses_need_not_be_consistent();
  what_does_not_exist_is_not_found();
  slopes_are_guessed();
  questions_leave_explanations();
  return failures != 0;
}
