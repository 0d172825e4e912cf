/* SPDX-License-Identifier: BSD-3-Clause
 *
 * More equations than unknowns: a reaction together with its conservation law, k = 1 + sin(t) / 2.
 *
 *     x1' = -k x1,   x2' = k x1,   0 = x1 + x2 - 1 - leak t
 *
 * leak = 0: the derivative of the law follows from the other equations. mu = 1, d = 1, a = 1, v = 1, and
 * x1 = x1(0) exp(-t - (1 - cos t) / 2), x2 = 1 - x1; the law holds to rounding.
 * leak != 0: the equations contradict each other, there is no solution, and the solver says so. */
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = matrix[4] = 1;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  const double k = (order == 0 ? 1 : 0) + 0.5 * sin(t + order * acos(0.0));
  (void)user;
  matrix[0] = -k, matrix[1] = k;
  if (order == 0) matrix[2] = matrix[5] = 1;
  return 0;
}

static int f(double t, int order, double* vector, void* user) {
  const double leak = *(const double*)user;
  if (order == 0) vector[2] = -1 - leak * t;
  if (order == 1) vector[2] = -leak;
  return 0;
}

int main(void) {
  sfdae_linear_problem problem;
  sfdae_characteristics c;
  sfdae_solver* solver = NULL;
  double leak = 0, t = 0, x[2] = {0.9, 0.1}, exact = 0.9 * exp(-3 - (1 - cos(3)) / 2), error = HUGE_VAL, law = 1;
  int status, contradiction;

  sfdae_linear_problem_init(&problem, sizeof problem);
  sfdae_characteristics_init(&c, sizeof c);
  problem.num_equations = 3, problem.num_unknowns = 2;
  problem.E = E, problem.A = A, problem.f = f, problem.user = &leak;
  status = sfdae_create_linear(&solver, &problem, NULL);
  if (status >= 0) status = sfdae_start(solver, 0, 3, x, NULL);
  if (status >= 0) status = sfdae_advance(solver, 3, &t, x, NULL);
  if (status >= 0) status = sfdae_get_characteristics(solver, &c);
  if (status >= 0) error = fabs(x[0] - exact) / (1e-6 * exact + 1e-6), law = fabs(x[0] + x[1] - 1);
  printf("%s %s\nmu = %d, d = %d, a = %d, u = %d, v = %d\n", sfdae_status_name(status), sfdae_message(solver),
         c.strangeness_index, c.differential, c.algebraic, c.undetermined, c.redundant);
  printf("error %.2g times the tolerance, x1 + x2 - 1 = %.1e\n", error, law);

  leak = 0.1;
  contradiction = sfdae_start(solver, 0, 3, x, NULL);
  printf("with a leak: %s\n", sfdae_message(solver));
  sfdae_destroy(&solver);
  return !(error <= 10 && law <= 1e-14 && c.redundant == 1 && contradiction == SFDAE_INCONSISTENT_EQUATIONS);
}
