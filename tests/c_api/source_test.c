/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Source text of models: lengths of texts, and what has none.
 */
#include <stddef.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

/* x0' = x1, 0 = x0^3 + x0 - sin t; or with a table in place of sin; or one equation in two unknowns. */
enum { PLAIN, WITH_TABLE, TOO_FEW };

static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const double at[] = {0, 1, 2, 3, 4, 5}, values[] = {0, 1, 0, 1, 0, 1};
  const int kind = *(const int*)user;
  const sfdae_expression input = kind == WITH_TABLE ? sfdae_table(t, 3, 6, at, values) : sfdae_sin(t);
  const sfdae_expression cube = sfdae_multiply(x[0], sfdae_multiply(x[0], x[0]));
  (void)record;
  F[0] = sfdae_subtract(xdot[0], x[1]);
  if (kind != TOO_FEW) F[1] = sfdae_subtract(sfdae_add(cube, x[0]), input);
  return 0;
}

static sfdae_solver* solver_of(int* kind) {
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem problem;
  CHECK_STATUS(sfdae_nonlinear_problem_init(&problem, sizeof problem), SFDAE_OK);
  problem.num_equations = *kind == TOO_FEW ? 1 : 2;
  problem.num_unknowns = 2;
  problem.equations = equations;
  problem.user = kind;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  return solver;
}

static void text_has_the_length_that_is_needed(void) {
  int kind = PLAIN;
  sfdae_solver* solver = solver_of(&kind);
  static char text[20000];
  double x[2] = {0, 1}, t = 0;
  size_t needed = 7;
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, "wave", text, sizeof text, &needed), SFDAE_NOT_STARTED);
  CHECK(needed == 7 && text[0] == '\0');
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, "wave", NULL, 0, &needed), SFDAE_OK);
  CHECK(needed > 500 && needed < sizeof text);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, "wave", text, sizeof text, NULL), SFDAE_OK);
  CHECK(strlen(text) + 1 == needed);
  CHECK(strstr(text, "void wave_residual(double t, const double *z") != NULL);
  CHECK(strstr(text, "wave_mu = 1") != NULL && strstr(text, "wave_size = 3") != NULL);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_FORTRAN, "wave", text, 11, &needed), SFDAE_OK);
  CHECK(strlen(text) == 10 && needed > 500);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK); /* goes on */
  sfdae_destroy(&solver);
}

static void arguments_are_checked(void) {
  int kind = PLAIN;
  sfdae_solver* solver = solver_of(&kind);
  char text[8] = "before";
  double x[2] = {0, 1};
  size_t needed = 7;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_export_source(NULL, SFDAE_SOURCE_C, "a", text, 8, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_export_source(solver, 2, "a", text, 8, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_export_source(solver, -1, "a", text, 8, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, NULL, text, 8, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, "", text, 8, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, "2a", text, 8, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, "a b", text, 8, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, "a", NULL, 8, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(needed == 7 && strcmp(text, "before") == 0);
  sfdae_destroy(&solver);
}

static void what_is_no_formula_is_named(void) {
  int kind = WITH_TABLE;
  sfdae_solver* solver = solver_of(&kind);
  double x[2] = {0, 1};
  CHECK(sfdae_start(solver, 0.5, 1, x, NULL) >= 0);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, "a", NULL, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solver), "table") != NULL);
  sfdae_destroy(&solver);
  kind = TOO_FEW;
  solver = solver_of(&kind);
  CHECK(sfdae_start(solver, 0, 1, x, NULL) >= 0);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, "a", NULL, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solver), "as many as unknowns") != NULL);
  sfdae_destroy(&solver);
}

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = 1;
  return 0;
}

static void problems_of_callbacks_have_no_source(void) {
  sfdae_solver* solver = NULL;
  sfdae_linear_problem problem;
  double x[1] = {1};
  CHECK_STATUS(sfdae_linear_problem_init(&problem, sizeof problem), SFDAE_OK);
  problem.num_equations = problem.num_unknowns = 1;
  problem.E = problem.A = E;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  CHECK(sfdae_start(solver, 0, 1, x, NULL) >= 0);
  CHECK_STATUS(sfdae_export_source(solver, SFDAE_SOURCE_C, "a", NULL, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solver), "recorded") != NULL);
  sfdae_destroy(&solver);
}

int main(void) {
  text_has_the_length_that_is_needed();
  arguments_are_checked();
  what_is_no_formula_is_named();
  problems_of_callbacks_have_no_source();
  return failures != 0;
}
