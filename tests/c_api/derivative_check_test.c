/* SPDX-License-Identifier: BSD-3-Clause
 *
 * sfdae_check_derivatives: right derivatives are not suspected, one wrong entry is found where it is.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

/* m = 2, n = 3, every entry p_ij cos(w_ij t + q_ij); one entry of one derivative is off by `offset` and the
 * derivatives above `highest` are not available. */
enum { M = 2, N = 3 };

typedef struct {
  double scale; /* of all functions */
  char function;
  int order, row, column;
  double offset;
  int highest;
} mistake;

static double entry(char function, int i, int j, double t, int order) {
  const double w = 0.7 + 0.3 * i + 0.2 * j + (function == 'A' ? 0.1 : 0);
  const double q = function == 'E' ? 0.4 : function == 'A' ? 1.3 : 2.2;
  return (1 + 0.5 * i - 0.25 * j) * pow(w, order) * cos(w * t + q + order * acos(0.0));
}

static int matrix_function(const mistake* wrong, char function, double t, int order, double* matrix, int columns) {
  int i, j;
  if (order > wrong->highest) return SFDAE_ORDER_NOT_AVAILABLE;
  for (j = 0; j < columns; j++)
    for (i = 0; i < M; i++) matrix[i + M * j] = wrong->scale * entry(function, i, j, t, order);
  if (function == wrong->function && order == wrong->order)
    matrix[wrong->row + M * wrong->column] += wrong->scale * wrong->offset;
  return 0;
}

static int E(double t, int order, double* matrix, void* user) {
  return matrix_function((const mistake*)user, 'E', t, order, matrix, N);
}
static int A(double t, int order, double* matrix, void* user) {
  return matrix_function((const mistake*)user, 'A', t, order, matrix, N);
}
static int f(double t, int order, double* vector, void* user) {
  return matrix_function((const mistake*)user, 'f', t, order, vector, 1);
}

static sfdae_solver* create(mistake* wrong) {
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = M;
  problem.num_unknowns = N;
  problem.E = E;
  problem.A = A;
  problem.f = f;
  problem.user = wrong;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  return solver;
}

static sfdae_derivative_check check(mistake* wrong, double t, int max_order) {
  sfdae_derivative_check result;
  sfdae_solver* solver = create(wrong);
  sfdae_derivative_check_init(&result, sizeof result);
  CHECK_STATUS(sfdae_check_derivatives(solver, t, max_order, &result), SFDAE_OK);
  CHECK(result.size == sizeof result);
  CHECK(result.error >= 0 && result.uncertainty >= 0);
  CHECK(result.suspicious == (result.error > 100 * result.uncertainty));
  sfdae_destroy(&solver);
  return result;
}

static const double scales[] = {1e-8, 1, 1e8};

static void right_derivatives_are_not_suspected(void) {
  int k, t, max_order;
  for (k = 0; k < 3; k++)
    for (t = -3; t <= 3; t++)
      for (max_order = 1; max_order <= 4; max_order++) {
        mistake none = {1, 0, 0, 0, 0, 0, 99};
        sfdae_derivative_check result;
        none.scale = scales[k];
        result = check(&none, t, max_order);
        CHECK(!result.suspicious);
        CHECK(result.function == 'E' || result.function == 'A' || result.function == 'f');
        CHECK(result.order >= 1 && result.order <= max_order);
        CHECK(result.row >= 0 && result.row < M && result.column >= 0 && result.column < N);
      }
}

/* An offset of a thousandth of a derivative of order k: that of order k + 1 remains the derivative of what is
 * supplied, so that this entry and this order alone are wrong. */
static void one_wrong_entry_is_found(void) {
  static const char functions[] = {'E', 'A', 'f'};
  int function, order, row, column, k;
  for (k = 0; k < 3; k++)
    for (function = 0; function < 3; function++)
      for (order = 1; order <= 2; order++)
        for (row = 0; row < M; row++)
          for (column = 0; column < (functions[function] == 'f' ? 1 : N); column++) {
            mistake wrong = {1, 0, 0, 0, 0, 1e-3, 99};
            sfdae_derivative_check result;
            const int failures_before = failures;
            wrong.scale = scales[k];
            wrong.function = functions[function];
            wrong.order = order;
            wrong.row = row;
            wrong.column = column;
            result = check(&wrong, 0.6, 3);
            CHECK(result.suspicious);
            CHECK(result.function == wrong.function && result.order == order);
            CHECK(result.row == row && result.column == column);
            CHECK(fabs(result.supplied - result.difference - scales[k] * 1e-3) <= 0.01 * scales[k] * 1e-3);
            if (failures > failures_before)
              fprintf(stderr, "  ... %c^(%d)(%d,%d), found %c^(%d)(%d,%d)\n", wrong.function, order, row, column,
                      result.function ? result.function : '0', result.order, result.row, result.column);
          }
}

/* The mistakes that people make: a sign, a forgotten inner derivative. */
static void wrong_signs_are_found(void) {
  mistake wrong = {1, 'A', 1, 1, 2, 0, 99};
  sfdae_derivative_check result;
  wrong.offset = -2 * entry('A', 1, 2, 0.6, 1);
  result = check(&wrong, 0.6, 1);
  CHECK(result.suspicious && result.function == 'A' && result.order == 1 && result.row == 1 && result.column == 2);
  CHECK(fabs(result.supplied + result.difference) <= 1e-2 * fabs(result.difference));
}

static void mistakes_above_max_order_are_not_looked_for(void) {
  mistake wrong = {1, 'E', 2, 0, 0, 0.1, 99};
  CHECK(!check(&wrong, 0.6, 1).suspicious);
  CHECK(check(&wrong, 0.6, 2).suspicious);
}

static void missing_orders_are_passed_over(void) {
  mistake none = {1, 0, 0, 0, 0, 0, 0};
  sfdae_derivative_check result = check(&none, 0.6, 3);
  CHECK(result.function == 0 && !result.suspicious);
  none.highest = 1;
  result = check(&none, 0.6, 3);
  CHECK(result.function != 0 && result.order == 1 && !result.suspicious);
}

static int constant(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  CHECK(order == 0);
  matrix[0] = 1;
  return 0;
}

static void constants_have_nothing_to_compare(void) {
  sfdae_linear_problem problem;
  sfdae_derivative_check result;
  sfdae_solver* solver = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  sfdae_derivative_check_init(&result, sizeof result);
  problem.num_equations = problem.num_unknowns = 1;
  problem.E = problem.A = constant;
  problem.constant_E = problem.constant_A = 1;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_check_derivatives(solver, 0, 2, &result), SFDAE_OK);
  CHECK(result.function == 0 && !result.suspicious);
  sfdae_destroy(&solver);
}

int main(void) {
  right_derivatives_are_not_suspected();
  one_wrong_entry_is_found();
  wrong_signs_are_found();
  mistakes_above_max_order_are_not_looked_for();
  missing_orders_are_passed_over();
  constants_have_nothing_to_compare();
  return failures != 0;
}
