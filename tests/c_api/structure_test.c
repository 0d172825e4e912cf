/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The structure of recorded equations: what sfdae_get_structure returns for linear equations and for nonlinear ones,
 * and what it refuses.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

/* x0' = x1, 0 = x0 - sin t (linear) or 0 = x0^3 + x0 - sin t: the second one is differentiated once. */
static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const int is_linear = *(const int*)user;
  sfdae_expression left = x[0];
  (void)record;
  if (!is_linear) left = sfdae_add(sfdae_multiply(x[0], sfdae_multiply(x[0], x[0])), x[0]);
  F[0] = sfdae_subtract(xdot[0], x[1]);
  F[1] = sfdae_subtract(left, sfdae_sin(t));
  return 0;
}

static int one_equation(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                        const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  (void)record, (void)xdot, (void)user;
  F[0] = sfdae_subtract(sfdae_multiply(x[0], x[1]), t);
  return 0;
}

static int total_derivative(double t, int order, const double* jet, double* F, double* F_x, double* F_xdot,
                            void* user) {
  (void)t, (void)order, (void)jet, (void)F, (void)F_x, (void)F_xdot, (void)user;
  return 0;
}

static sfdae_solver* solver_of(sfdae_equations_function function, int m, int n, int* user) {
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem problem;
  CHECK_STATUS(sfdae_nonlinear_problem_init(&problem, sizeof problem), SFDAE_OK);
  problem.num_equations = m;
  problem.num_unknowns = n;
  problem.equations = function;
  if (function == NULL) problem.total_derivative = total_derivative;
  problem.user = user;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  return solver;
}

static void both_kinds_have_a_structure(void) {
  int is_linear;
  for (is_linear = 0; is_linear <= 1; is_linear++) {
    sfdae_solver* solver = solver_of(equations, 2, 2, &is_linear);
    sfdae_structure structure;
    int counts[2] = {9, 9}, orders[2] = {9, 9}, assigned[2] = {9, 9}, block[2] = {9, 9};
    double x[2] = {0, 1};
    CHECK_STATUS(sfdae_structure_init(&structure, sizeof structure), SFDAE_OK);
    CHECK_STATUS(sfdae_get_structure(solver, &structure, NULL, NULL, NULL, NULL), SFDAE_OK);
    CHECK(structure.verdict == SFDAE_STRUCTURE_UNCHECKED && structure.smallest_pivot == 0);
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_get_structure(solver, &structure, counts, orders, assigned, block), SFDAE_OK);
    CHECK(structure.has_assignment == 1 && structure.freedom == 0 && structure.index_bound == 1);
    CHECK(structure.num_blocks == 2 && structure.largest_block == 1 && structure.doubtful_block == -1);
    CHECK(structure.verdict == SFDAE_STRUCTURE_CERTIFIED && structure.smallest_pivot > 0.5);
    CHECK(structure.is_followed == !is_linear);
    CHECK(counts[0] == 0 && counts[1] == 1);
    CHECK(orders[0] == 1 && orders[1] == 0);
    CHECK(assigned[0] == 1 && assigned[1] == 0);
    CHECK(block[1] == 0 && block[0] == 1);
    CHECK(strcmp(sfdae_message(solver), "") == 0);
    sfdae_destroy(&solver);
  }
}

static void other_problems_are_refused(void) {
  int is_linear = 0, counts[2] = {7, 7};
  sfdae_structure structure;
  sfdae_solver* solver = solver_of(one_equation, 1, 2, &is_linear);
  sfdae_structure_init(&structure, sizeof structure);
  structure.freedom = 77;
  CHECK_STATUS(sfdae_get_structure(solver, &structure, counts, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solver), "as many as unknowns") != NULL);
  sfdae_destroy(&solver);
  solver = solver_of(NULL, 2, 2, NULL);
  CHECK_STATUS(sfdae_get_structure(solver, &structure, counts, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(counts[0] == 7 && structure.freedom == 77);
  CHECK_STATUS(sfdae_get_structure(NULL, &structure, NULL, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_structure(solver, NULL, NULL, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  structure.size = 0;
  CHECK_STATUS(sfdae_get_structure(solver, &structure, NULL, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_structure_init(NULL, sizeof structure), SFDAE_ILLEGAL_ARGUMENT);
  sfdae_destroy(&solver);
}

static void the_option_is_checked(void) {
  int is_linear = 0;
  sfdae_options options;
  sfdae_solver* solver = solver_of(equations, 2, 2, &is_linear);
  sfdae_options_init(&options, sizeof options);
  CHECK(options.structure == SFDAE_STRUCTURE_AUTOMATIC);
  options.structure = 3;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solver), "structure is 3") != NULL);
  sfdae_destroy(&solver);
}

/* Another array of derivatives makes another analysis necessary. */
static void a_change_ends_the_integration(void) {
  int is_linear = 0;
  double x[2] = {0, 1}, t = 0;
  sfdae_options options;
  sfdae_structure structure;
  sfdae_solver* solver = solver_of(equations, 2, 2, &is_linear);
  sfdae_options_init(&options, sizeof options);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  options.structure = SFDAE_STRUCTURE_OFF;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  sfdae_structure_init(&structure, sizeof structure);
  CHECK_STATUS(sfdae_get_structure(solver, &structure, NULL, NULL, NULL, NULL), SFDAE_OK);
  CHECK(structure.is_followed == 0 && structure.verdict == SFDAE_STRUCTURE_CERTIFIED);
  sfdae_destroy(&solver);
}

/* A capacitor between two nodes: x0' - x1' + x0 - sin t = 0 and x1' - x0' + x1 = 0, C times the slopes. The sum has
 * none. */
static int floating_capacitor(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                              const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression C = sfdae_number(1e-9);
  const sfdae_expression current = sfdae_multiply(C, sfdae_subtract(xdot[0], xdot[1]));
  (void)record, (void)user;
  F[0] = sfdae_add(current, sfdae_subtract(sfdae_multiply(x[0], sfdae_exp(x[0])), sfdae_sin(t)));
  F[1] = sfdae_subtract(x[1], current);
  return 0;
}

static void replaced_equations_are_shown(void) {
  double x[2] = {0, 0};
  char report[4000];
  int count = 0, orders[2] = {9, 9};
  sfdae_options options;
  sfdae_structure structure;
  sfdae_decision decision;
  sfdae_solver* solver = solver_of(floating_capacitor, 2, 2, NULL);
  sfdae_options_init(&options, sizeof options);
  sfdae_structure_init(&structure, sizeof structure);
  sfdae_decision_init(&decision, sizeof decision);
  CHECK_STATUS(sfdae_start(solver, 0, 1e-6, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_structure(solver, &structure, NULL, NULL, NULL, NULL), SFDAE_OK);
  CHECK(structure.verdict == SFDAE_STRUCTURE_MISLEADS && structure.freedom == 2 && structure.num_replaced == 0);
  CHECK(strstr(sfdae_message(solver), "the derivative array decides") != NULL);
  CHECK_STATUS(sfdae_report(solver, report, sizeof report, NULL), SFDAE_OK);
  CHECK(strstr(report, "Structure") == NULL);
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1e-6, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_structure(solver, &structure, NULL, orders, NULL, NULL), SFDAE_OK);
  CHECK(structure.verdict == SFDAE_STRUCTURE_CERTIFIED && structure.freedom == 1 && structure.num_replaced == 1);
  CHECK(orders[0] == 1 && orders[1] == 1);
  CHECK_STATUS(sfdae_get_num_decisions(solver, &count), SFDAE_OK);
  CHECK(count == structure.num_blocks);
  CHECK_STATUS(sfdae_get_decision(solver, count - 1, &decision), SFDAE_OK);
  CHECK(decision.what == SFDAE_DECISION_BLOCK && decision.stage == count - 1 && decision.rank == decision.rows);
  CHECK_STATUS(sfdae_report(solver, report, sizeof report, NULL), SFDAE_OK);
  CHECK(strstr(report, "1 equation was replaced") != NULL && strstr(report, "states: x[") != NULL);
  CHECK(strstr(report, "determine") != NULL && strstr(report, "equation 1+") != NULL);
  sfdae_destroy(&solver);
}

int main(void) {
  both_kinds_have_a_structure();
  other_problems_are_refused();
  the_option_is_checked();
  a_change_ends_the_integration();
  replaced_equations_are_shown();
  return failures != 0;
}
