/* SPDX-License-Identifier: BSD-3-Clause
 *
 * sfdae_check_total_derivatives: right derivatives are not suspected, one wrong entry is found where it is.
 */
#include <stdio.h>
#include <stdlib.h>

#include "nonlinear_pendulum.h"

enum { HIGHEST = 3 };

typedef struct {
  char function; /* 'F', 'x', 'd' or 0 */
  int order, row, column;
  double offset;
  int highest;   /* order that is available */
  double domain; /* no values for t beyond */
} mistake;

/* F2^(k) offset by one derivative alone: that of order k + 1 remains the derivative of what is right, so that order k
 * + 1 does not fit any more, either; the first one counts. */
static int derivative(double t, int k, const double* jet, double* F, double* F_x, double* F_xdot, void* user) {
  const mistake* wrong = (const mistake*)user;
  if (k > wrong->highest) return SFDAE_ORDER_NOT_AVAILABLE;
  if (t > wrong->domain) return 1;
  pendulum_derivative(t, k, jet, F, F_x, F_xdot, NULL);
  if (k != wrong->order) return 0;
  if (wrong->function == 'F') F[wrong->row] += wrong->offset;
  if (wrong->function == 'x' && F_x) F_x[wrong->row + M * wrong->column] += wrong->offset;
  if (wrong->function == 'd' && F_xdot) F_xdot[wrong->row + M * wrong->column] += wrong->offset;
  return 0;
}

static void any_jet(double scale, double* jet) {
  int i;
  for (i = 0; i < N * (HIGHEST + 2); i++) jet[i] = scale * cos(1.0 + 2.3 * i);
}

static sfdae_derivative_check check(mistake* wrong, double t, double scale, int max_order) {
  sfdae_nonlinear_problem problem = pendulum_problem();
  sfdae_derivative_check result;
  sfdae_solver* solver;
  double jet[N * (HIGHEST + 2)];
  any_jet(scale, jet);
  problem.total_derivative = derivative;
  problem.user = wrong;
  solver = CREATE(&problem, NULL);
  sfdae_derivative_check_init(&result, sizeof result);
  CHECK_STATUS(sfdae_check_total_derivatives(solver, t, jet, max_order, &result), SFDAE_OK);
  CHECK((strlen(sfdae_message(solver)) > 10) == result.suspicious);
  CHECK(result.suspicious == (result.error > 100 * result.uncertainty));
  sfdae_destroy(&solver);
  return result;
}

static mistake no_mistake(void) {
  mistake none = {0, 0, 0, 0, 0, 99, INFINITY};
  return none;
}

static void right_derivatives_are_not_suspected(void) {
  static const double scales[] = {1e-6, 1e-3, 1, 1e3, 1e6};
  int k, t, max_order;
  for (k = 0; k < 5; k++)
    for (t = -2; t <= 2; t++)
      for (max_order = 0; max_order <= HIGHEST; max_order++) {
        mistake none = no_mistake();
        const sfdae_derivative_check result = check(&none, 0.3 * t, scales[k], max_order);
        CHECK(!result.suspicious);
        CHECK(result.function == 'F' || result.function == 'x' || result.function == 'd');
        CHECK(result.order >= 0 && result.order <= max_order);
        CHECK(result.row >= 0 && result.row < M && result.column >= 0 && result.column < N);
      }
}

static void one_wrong_entry_is_found(void) {
  static const char functions[] = {'F', 'x', 'd'};
  int function, order, row, column;
  for (function = 0; function < 3; function++)
    for (order = function == 0; order <= 2; order++)
      for (row = 0; row < M; row++)
        for (column = 0; column < (function == 0 ? 1 : N); column++) {
          const int failures_before = failures;
          mistake wrong = no_mistake();
          sfdae_derivative_check result;
          wrong.function = functions[function];
          wrong.order = order;
          wrong.row = row;
          wrong.column = column;
          wrong.offset = 1e-3;
          result = check(&wrong, 0.6, 1, 3);
          CHECK(result.suspicious);
          CHECK(result.function == wrong.function && result.order == order);
          CHECK(result.row == row && result.column == column);
          CHECK(fabs(result.supplied - result.difference - 1e-3) <= 1e-5);
          if (failures > failures_before)
            fprintf(stderr, "  ... %c^(%d)(%d,%d), found %c^(%d)(%d,%d)\n", wrong.function, order, row, column,
                    result.function ? result.function : '0', result.order, result.row, result.column);
        }
}

static void what_is_not_available_is_passed_over(void) {
  mistake wrong = no_mistake();
  sfdae_derivative_check result;
  wrong.function = 'x';
  wrong.order = 2;
  wrong.row = 2;
  wrong.offset = 1;
  CHECK(check(&wrong, 0, 1, 2).suspicious);
  CHECK(!check(&wrong, 0, 1, 1).suspicious);
  wrong.highest = 1;
  CHECK(!check(&wrong, 0, 1, 2).suspicious);
  wrong.highest = -1;
  result = check(&wrong, 0, 1, 2);
  CHECK(result.function == 0 && !result.suspicious);
}

/* Near the end of the domain the points are closer. */
static void ends_of_the_domain_are_avoided(void) {
  mistake wrong = no_mistake();
  wrong.domain = 0.6001;
  CHECK(!check(&wrong, 0.6, 1, 2).suspicious);
  wrong.function = 'F';
  wrong.order = 1;
  wrong.offset = 1;
  CHECK(check(&wrong, 0.6, 1, 2).suspicious);
}

static void wrong_arguments_are_refused(void) {
  static const int orders[] = {-1, 14, -1000000};
  mistake none = no_mistake();
  sfdae_nonlinear_problem problem = pendulum_problem();
  sfdae_derivative_check result, before;
  double jet[N * (HIGHEST + 2)];
  sfdae_solver* solver;
  int k;
  any_jet(1, jet);
  problem.total_derivative = derivative;
  problem.user = &none;
  solver = CREATE(&problem, NULL);
  sfdae_derivative_check_init(&result, sizeof result);
  before = result;
  for (k = 0; k < 3; k++)
    CHECK_STATUS(sfdae_check_total_derivatives(solver, 0, jet, orders[k], &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_total_derivatives(solver, NAN, jet, 1, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_total_derivatives(solver, 0, NULL, 1, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_total_derivatives(solver, 0, jet, 1, NULL), SFDAE_ILLEGAL_ARGUMENT);
  jet[N * 2] = INFINITY;
  CHECK_STATUS(sfdae_check_total_derivatives(solver, 0, jet, 1, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_total_derivatives(solver, 0, jet, 0, &result), SFDAE_OK); /* not that far */
  result = before;
  jet[N * 2] = 1;
  none.domain = -1;
  CHECK_STATUS(sfdae_check_total_derivatives(solver, 0, jet, 1, &result), SFDAE_CALLBACK_FAILED);
  CHECK(memcmp(&result, &before, sizeof result) == 0);
  result.size = 0;
  CHECK_STATUS(sfdae_check_total_derivatives(solver, 0, jet, 1, &result), SFDAE_ILLEGAL_ARGUMENT);
  sfdae_destroy(&solver);

  /* Recorded equations are differentiated by the library. */
  problem = recorded_pendulum();
  solver = CREATE(&problem, NULL);
  result = before;
  CHECK_STATUS(sfdae_check_total_derivatives(solver, 0, jet, 1, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(memcmp(&result, &before, sizeof result) == 0);
  sfdae_destroy(&solver);
}

int main(void) {
  right_derivatives_are_not_suspected();
  one_wrong_entry_is_found();
  what_is_not_available_is_passed_over();
  ends_of_the_domain_are_avoided();
  wrong_arguments_are_refused();
  return failures != 0;
}
