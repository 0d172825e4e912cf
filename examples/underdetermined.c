/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Fewer equations than unknowns: a cart with friction, position p, velocity v, and a driving force F that no
 * equation determines. mu = 0, d = 2, u = 1.
 *
 *     p' = v,   v' = -v + F
 *
 * By itself the solver holds the free part constant: F = F0, v = F0 + (v0 - F0) e^-t,
 * p = p0 + F0 t + (v0 - F0)(1 - e^-t). With F prescribed as cos t: v = (cos t + sin t) / 2 + c e^-t,
 * p = p0 + (sin t - cos t + 1) / 2 + c (1 - e^-t), c = v0 - 1/2.
 */
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)order, (void)user;
  matrix[0] = matrix[3] = 1;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  (void)t, (void)order, (void)user;
  matrix[2] = 1, matrix[3] = -1, matrix[5] = 1;
  return 0;
}

static int force(double t, int order, double* values, void* user) {
  (void)order, (void)user;
  values[0] = cos(t);
  return 0;
}

/* Error at t = 5 in units of the tolerance, or infinity if anything fails. */
static double solve(int prescribe) {
  const int prescribed[1] = {2};
  const double tend = 5, e = exp(-tend), F = prescribe ? cos(tend) : 0.25, c = 1 - (prescribe ? 0.5 : F);
  const double v = prescribe ? (cos(tend) + sin(tend)) / 2 + c * e : F + c * e;
  const double p = (prescribe ? (sin(tend) - cos(tend) + 1) / 2 : F * tend) + c * (1 - e);
  double t = 0, x[3] = {0, 1, 0.25}, error;
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  int status;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = 2, problem.num_unknowns = 3;
  problem.E = E, problem.A = A, problem.constant_E = problem.constant_A = 1;
  if (prescribe) problem.num_prescribed = 1, problem.prescribed = prescribed, problem.prescribed_values = force;
  status = sfdae_create_linear(&solver, &problem, NULL);
  if (status >= 0) status = sfdae_start(solver, 0, tend, x, NULL);
  if (status >= 0) status = sfdae_advance(solver, tend, &t, x, NULL);
  error = fmax(fmax(fabs(x[0] - p) / (1 + fabs(p)), fabs(x[1] - v) / (1 + fabs(v))), fabs(x[2] - F) / (1 + fabs(F)));
  printf("%s: %s %s\n  p = %.6f, v = %.6f, F = %.6f, error %.2g times the tolerance\n",
         prescribe ? "F = cos t" : "F free", sfdae_status_name(status), sfdae_message(solver), x[0], x[1], x[2],
         error / 1e-6);
  sfdae_destroy(&solver);
  return status >= 0 ? error / 1e-6 : HUGE_VAL;
}

int main(void) { return !(solve(0) <= 10 && solve(1) <= 10); }
