/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Singular points: what is said of them, which are passed, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sfdae/branches.h>

#include "checks.h"

#define NEAR(a, b, tol) CHECK(fabs((a) - (b)) <= (tol))

/* sin t, cos t; at pi/2 another solution begins, x1 = 1: x1' = x2, x1^2 + x2^2 = 1. */
static int circle(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                  sfdae_expression* F, void* user) {
  (void)record, (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[1]);
  F[1] = sfdae_subtract(sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1])), sfdae_number(1));
  return 0;
}

static sfdae_solver* create(void) {
  sfdae_nonlinear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = 1e-7;
  problem.num_equations = problem.num_unknowns = 2;
  problem.equations = circle;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  return solver;
}

static void crossings_are_passed_up_to_a_number(void) {
  double t, x[2] = {0, 1};
  const double pi = acos(-1.0);
  sfdae_singular_point point;
  sfdae_solver* solver = create();
  CHECK_STATUS(sfdae_singular_point_init(&point, sizeof point), SFDAE_OK);
  CHECK_STATUS(sfdae_pass_singular_points(solver, 1), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 10, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_singular_point(solver, &point), SFDAE_NOT_STARTED);
  CHECK(strstr(sfdae_message(solver), "no singular point") != NULL);
  CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_OK);
  NEAR(x[0], sin(3.0), 1e-4);
  NEAR(x[1], cos(3.0), 1e-4);
  CHECK_STATUS(sfdae_get_singular_point(solver, &point), SFDAE_OK);
  CHECK(point.kind == SFDAE_SINGULAR_CROSSING && point.passed == 1 && point.count == 1 && point.component == -1);
  NEAR(point.t, pi / 2, 1e-4);
  CHECK(point.t_before <= point.t && point.t < point.t_after);
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_CHARACTERISTICS_CHANGED);
  NEAR(t, 1.5 * pi, 1e-3);
  CHECK_STATUS(sfdae_get_singular_point(solver, &point), SFDAE_OK);
  CHECK(point.passed == 0 && point.count == 1);
  CHECK_STATUS(sfdae_pass_singular_points(solver, 2), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 7, &t, x, NULL), SFDAE_OK);
  NEAR(x[0], sin(7.0), 1e-3);
  CHECK_STATUS(sfdae_get_singular_point(solver, &point), SFDAE_OK);
  CHECK(point.passed == 1 && point.count == 2);
  /* A new start has met none. */
  x[0] = 0, x[1] = 1;
  CHECK_STATUS(sfdae_start(solver, 0, 10, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_singular_point(solver, &point), SFDAE_NOT_STARTED);
  sfdae_destroy(&solver);
}

static int height(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = x[0] - 0.5;
  return 0;
}

static void none_is_passed_with_events(void) {
  double t, x[2] = {0, 1};
  sfdae_solver* solver = create();
  CHECK_STATUS(sfdae_set_events(solver, 1, height, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_pass_singular_points(solver, 5), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 3, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_EVENT);
  CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_CHARACTERISTICS_CHANGED);
  sfdae_destroy(&solver);
}

static void mistakes_are_refused(void) {
  sfdae_singular_point point;
  double x[2] = {0, 1};
  sfdae_solver* solver = create();
  CHECK_STATUS(sfdae_singular_point_init(NULL, sizeof point), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_singular_point_init(&point, 1), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_pass_singular_points(NULL, 1), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_pass_singular_points(solver, -1), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solver), "max_points = -1") != NULL);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_singular_point(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_singular_point(NULL, &point), SFDAE_ILLEGAL_ARGUMENT);
  sfdae_destroy(&solver);
}

int main(void) {
  crossings_are_passed_up_to_a_number();
  none_is_passed_with_events();
  mistakes_are_refused();
  return failures > 0;
}
