/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Gear, Petzold: ODE methods for the solution of differential/algebraic systems, SIAM J. Numer. Anal. 21 (1984).
 *
 *     x1  + eta t x2                   = e^-t
 *     x1' + eta t x2' + (1 + eta) x2   = 0          exact solution  x1 = (1 - eta t) e^-t,  x2 = e^-t
 *
 * Differentiate the first equation and subtract the second: x2 = e^-t. Strangeness index 1, d = 0, a = 2 for
 * every eta, although for eta = -1 the pencil (E, A) is singular at every t, and although implicit Euler applied
 * directly is unstable for eta < -1/2. */
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

static int E(double t, int order, double* matrix, void* user) {
  const double eta = *(const double*)user;
  if (order == 0) matrix[1] = 1, matrix[3] = eta * t;
  if (order == 1) matrix[3] = eta;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  const double eta = *(const double*)user;
  if (order == 0) matrix[0] = -1, matrix[2] = -eta * t, matrix[3] = -(1 + eta);
  if (order == 1) matrix[2] = -eta;
  return 0;
}

static int f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[0] = order % 2 ? -exp(-t) : exp(-t);
  return 0;
}

int main(void) {
  double etas[] = {-2, -1, -0.5, 0, 1, 10};
  int k, wrong = 0;
  for (k = 0; k < 6; k++) {
    const double eta = etas[k];
    sfdae_linear_problem problem;
    sfdae_solver* solver = NULL;
    double t = 0, x[2] = {0, 0}, error = HUGE_VAL;
    int status;
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = 2;
    problem.E = E;
    problem.A = A;
    problem.f = f;
    problem.user = &etas[k];
    status = sfdae_create_linear(&solver, &problem, NULL);
    if (status >= 0) status = sfdae_start(solver, 0, 5, x, NULL);
    if (status >= 0) status = sfdae_advance(solver, 5, &t, x, NULL);
    if (status >= 0) error = fmax(fabs(x[0] - (1 - eta * t) * exp(-t)), fabs(x[1] - exp(-t)));
    printf("eta = %4g: %s%s, error %.1e\n", eta, sfdae_status_name(status), sfdae_message(solver), error);
    if (!(error <= 1e-12)) wrong = 1;
    sfdae_destroy(&solver);
  }
  return wrong;
}
