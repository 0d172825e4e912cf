/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Modified nodal analysis: a source sin t from node 1 to ground, a capacitor (1) parallel to it, and R, L, C (all 1)
 * in series from node 1 by nodes 2 and 3 to ground. Unknowns: potentials e1, e2, e3, currents iL and iV.
 *
 *     e1' + (e1 - e2) + iV = 0,   (e2 - e1) + iL = 0,   e3' - iL = 0,   iL' = e2 - e3,   0 = e1 - sin t
 *
 * The capacitor at the source makes iV depend on (sin t)': strangeness index 1, d = 2, a = 3.
 * Check: q = e3 is a solution of q'' + q' + q = sin t; from q = q' = 0 at t = 0, with w = sqrt(3) / 2,
 *     q = -cos t + e^(-t/2) (cos w t + sin(w t) / (2 w)),   iL = q',   e2 = e1 - iL,   iV = -cos t - iL. */
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

enum { E1, E2, E3, IL, IV, N };

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)order, (void)user; /* constant: only order 0 is asked for */
  matrix[0 + N * E1] = matrix[2 + N * E3] = matrix[3 + N * IL] = 1;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  (void)t, (void)order, (void)user;
  matrix[0 + N * E1] = -1, matrix[0 + N * E2] = 1, matrix[0 + N * IV] = -1;
  matrix[1 + N * E1] = 1, matrix[1 + N * E2] = -1, matrix[1 + N * IL] = -1;
  matrix[2 + N * IL] = 1, matrix[3 + N * E2] = 1, matrix[3 + N * E3] = -1, matrix[4 + N * E1] = -1;
  return 0;
}

static int f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[4] = sin(t + order * acos(0.0));
  return 0;
}

int main(void) {
  const int fixed[N] = {0, 0, 1, 1, 0}; /* capacitor and coil; the rest follows */
  const double tend = 10, w = sqrt(0.75), decay = exp(-tend / 2);
  const double q = -cos(tend) + decay * (cos(w * tend) + sin(w * tend) / (2 * w));
  const double i = sin(tend) - decay * sin(w * tend) / w; /* q' */
  const double exact[N] = {sin(tend), sin(tend) - i, q, i, -cos(tend) - i};
  double t = 0, x[N] = {9, 9, 0, 0, 9}, error = 0; /* inconsistent: e1, e2, iV are wrong */
  sfdae_linear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  int status, k;

  sfdae_linear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  problem.num_equations = problem.num_unknowns = N;
  problem.E = E, problem.A = A, problem.f = f, problem.constant_E = problem.constant_A = 1;
  options.initial_values = SFDAE_INITIAL_FIXED, options.fixed = fixed;
  status = sfdae_create_linear(&solver, &problem, &options);
  if (status >= 0) status = sfdae_start(solver, 0, tend, x, NULL);
  if (status >= 0) printf("at 0: e = (%g, %g, %g), iL = %g, iV = %g\n", x[E1], x[E2], x[E3], x[IL], x[IV]);
  if (status >= 0) status = sfdae_advance(solver, tend, &t, x, NULL);
  for (k = 0; k < N; k++) error = fmax(error, fabs(x[k] - exact[k]) / (options.rtol * fabs(exact[k]) + options.atol));
  printf("%s %s\nerror %.2g times the tolerance\n", sfdae_status_name(status), sfdae_message(solver), error);
  sfdae_destroy(&solver);
  return !(status == SFDAE_OK && error <= 10);
}
