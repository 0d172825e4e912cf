/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The first example of GELDA's documentation (Kunkel, Mehrmann, Rath, Weickert, 1995), for any t:
 *
 *     0         = -x1 + t x2 + e^-t
 *     x1' - t x2' = 0                        exact solution  x1 = (1 + t) e^-t,  x2 = e^-t
 *
 * Strangeness index 1, d = 0, a = 2: initial values cannot be chosen. The solution is unique although the
 * matrix pencil (E(t), A(t)) is singular for every t. */
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

static int E(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[1] = 1, matrix[3] = -t; /* column by column: rows 0 and 1 of column 0, then column 1 */
  if (order == 1) matrix[3] = -1;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[0] = -1, matrix[2] = t;
  if (order == 1) matrix[2] = 1;
  return 0;
}

static int f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[0] = order % 2 ? -exp(-t) : exp(-t);
  return 0;
}

int main(void) {
  sfdae_linear_problem problem;
  sfdae_characteristics c;
  sfdae_solver* solver = NULL;
  double t = 0, x[2] = {5, -3}; /* anything: the start finds the consistent values */
  double error = HUGE_VAL;
  int status;

  sfdae_linear_problem_init(&problem, sizeof problem);
  sfdae_characteristics_init(&c, sizeof c);
  problem.num_equations = problem.num_unknowns = 2;
  problem.E = E;
  problem.A = A;
  problem.f = f;
  status = sfdae_create_linear(&solver, &problem, NULL);
  if (status >= 0) status = sfdae_analyze(solver, 0, 2, &c);
  if (status >= 0) status = sfdae_start(solver, 0, 2, x, NULL);
  if (status >= 0) status = sfdae_advance(solver, 2, &t, x, NULL);
  if (status >= 0) error = fmax(fabs(x[0] - (1 + t) * exp(-t)), fabs(x[1] - exp(-t)));

  printf("%s %s\n", sfdae_status_name(status), sfdae_message(solver));
  printf("mu = %d, d = %d, a = %d; x(%g) = (%.8f, %.8f), error %.1e\n", c.strangeness_index, c.differential,
         c.algebraic, t, x[0], x[1], error);
  sfdae_destroy(&solver);
  return !(error <= 1e-12 && c.strangeness_index == 1 && c.differential == 0 && c.algebraic == 2);
}
