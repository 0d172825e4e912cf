/* SPDX-License-Identifier: BSD-3-Clause */
/* x1' = x2,  0 = x1 - sin t;  index 2:  x1 = sin t,  x2 = cos t. Errors of the constraint and of its derivative are
 * rounding errors, so the solution is exact at every time. */
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = 1;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[2] = 1, matrix[1] = 1;
  return 0;
}

static int f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[1] = -sin(t + order * acos(0.0));
  return 0;
}

int main(void) {
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  double t = 0, x[2] = {0, 0}, error = 1;
  int status;

  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.E = E;
  problem.A = A;
  problem.f = f;
  status = sfdae_create_linear(&solver, &problem, NULL);
  if (status == SFDAE_OK) status = sfdae_start(solver, t, 2.0, x, NULL);
  if (status == SFDAE_OK) status = sfdae_advance(solver, 2.0, &t, x, NULL);
  if (status == SFDAE_OK) error = fabs(x[0] - sin(t)) + fabs(x[1] - cos(t));
  printf("sfdae %s: %s %s\nx(%g) = (%g, %g), error %g\n", sfdae_version(), sfdae_status_name(status),
         sfdae_message(solver), t, x[0], x[1], error);
  sfdae_destroy(&solver);
  return !(status == SFDAE_OK && t == 2.0 && error <= 1e-12);
}
