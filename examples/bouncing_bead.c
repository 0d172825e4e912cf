/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A bead slides without friction down a straight wire y = x and bounces off a stop at y = 0, where it keeps a part r of
 * its speed. lambda is the force of the wire:
 *
 *     x' = u,   y' = v,   u' = -lambda,   v' = -g + lambda,   0 = y - x
 *
 * Strangeness index 2, d = 2, a = 3. Events: y = 0, falling; the velocities are changed there, and it goes on.
 * Check: y'' = -g/2, so from rest at y = 1 it falls for T = 2 / sqrt(g) and flies for 2 r T, 2 r^2 T, ... after the
 * impacts. Impact k is at T (1 + 2 r + ... + 2 r^(k-1)), with v = -g T r^(k-1) / 2. */
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

enum { X, Y, U, V, LAMBDA, N };
static const double g = 9.81, r = 0.8;

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)order, (void)user; /* constant: only order 0 is asked for */
  matrix[0 + N * X] = matrix[1 + N * Y] = matrix[2 + N * U] = matrix[3 + N * V] = 1;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  (void)t, (void)order, (void)user;
  matrix[0 + N * U] = matrix[1 + N * V] = matrix[3 + N * LAMBDA] = matrix[4 + N * Y] = 1;
  matrix[2 + N * LAMBDA] = matrix[4 + N * X] = -1;
  return 0;
}

static int f(double t, int order, double* vector, void* user) {
  (void)t, (void)user;
  if (order == 0) vector[3] = -g;
  return 0;
}

static int stop(double t, const double* x, const double* xdot, double* value, void* user) {
  (void)t, (void)xdot, (void)user;
  value[0] = x[Y];
  return 0;
}

int main(void) {
  const double tend = 3, T = 2 / sqrt(g);
  const int falling = -1;
  double t = 0, x[N] = {1, 1, 0, 0, 0}, impact = T, flight = T, speed = g * T / 2, error = 0;
  int k, status, bounces = 0;
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = N;
  problem.E = E, problem.A = A, problem.f = f, problem.constant_E = problem.constant_A = 1;
  status = sfdae_create_linear(&solver, &problem, NULL);
  if (status >= 0) status = sfdae_set_events(solver, 1, stop, &falling, NULL);
  if (status >= 0) status = sfdae_start(solver, t, tend, x, NULL);
  while (status >= 0 && (status = sfdae_advance(solver, tend, &t, x, NULL)) == SFDAE_EVENT) {
    printf("impact %d at t = %.6f, y = %.1e, v = %.6f\n", ++bounces, t, x[Y], x[V]);
    error = fmax(error, fmax(fabs(t - impact), fmax(fabs(x[V] + speed), fabs(x[Y]))));
    x[U] *= -r, x[V] *= -r, flight *= r, speed *= r, impact += 2 * flight;
    status = sfdae_start(solver, t, tend, x, NULL);
  }
  for (k = 0, impact = T, flight = r * T; impact <= tend; k++, flight *= r)
    impact += 2 * flight; /* how many there are */
  printf("%s %s\nat t = %g, error %.1e\n", sfdae_status_name(status), sfdae_message(solver), t, error);
  sfdae_destroy(&solver);
  return !(status == SFDAE_OK && bounces == k && error <= 1e-4);
}
