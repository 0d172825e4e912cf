/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The strangeness-free system of a nonlinear problem along its solution. A pendulum in Cartesian coordinates,
 *
 *     x1' = x3,   x2' = x4,   x3' = -2 x1 x5,   x4' = -2 x2 x5 - g,   0 = x1^2 + x2^2 - 1,
 *
 * is for small changes dx at a point of the solution E1 dx' = A1 dx (d = 2 equations), 0 = A2 dx (a = 3, two of them
 * hidden in those above). The solution stays within all constraints: A2 x' = 0. */
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression force = sfdae_multiply(sfdae_number(2), x[4]);
  (void)record, (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(xdot[1], x[3]);
  F[2] = sfdae_add(xdot[2], sfdae_multiply(x[0], force));
  F[3] = sfdae_add(sfdae_add(xdot[3], sfdae_multiply(x[1], force)), sfdae_number(9.81));
  F[4] = sfdae_subtract(sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1])), sfdae_number(1));
  return 0;
}

static void print(const char* name, const double* matrix, int rows) {
  int i, j;
  for (i = 0; i < rows; i++)
    for (j = 0; j < 5; j++) printf("%s%8.4f%s", j ? " " : name, matrix[i + rows * j], j < 4 ? "" : "\n");
}

int main(void) {
  sfdae_nonlinear_problem problem;
  sfdae_solver* solver = NULL;
  double t = 0, x[5] = {0.8, -0.6, 0, 0, 0}, xdot[5], E1[10], A2[15], f1[2], f2[3], residual = 0, drift = 0;
  int i, j, k, status;

  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 5;
  problem.equations = equations;
  status = sfdae_create_nonlinear(&solver, &problem, NULL);
  if (status >= 0) status = sfdae_start(solver, 0, 1, x, NULL);
  for (k = 1; k <= 3 && status >= 0; k++) {
    status = sfdae_advance(solver, 0.3 * k, &t, x, xdot);
    if (status >= 0) status = sfdae_get_strangeness_free(solver, t, E1, NULL, f1, A2, f2, NULL);
    if (status < 0) break;
    printf("t = %.1f   x = %.4f %.4f %.4f %.4f %.4f\n", t, x[0], x[1], x[2], x[3], x[4]);
    print("  E1 ", E1, 2);
    print("  A2 ", A2, 3);
    for (i = 0; i < 3; i++) {
      double slope = 0;
      for (j = 0; j < 5; j++) slope += A2[i + 3 * j] * xdot[j];
      residual = fmax(residual, fmax(fabs(f1[i % 2]), fabs(f2[i])));
      drift = fmax(drift, fabs(slope));
    }
  }
  printf("%s %s\nresiduals %.1e, A2 x' %.1e\n", sfdae_status_name(status), sfdae_message(solver), residual, drift);
  sfdae_destroy(&solver);
  return !(status >= 0 && k == 4 && residual < 1e-11 && drift < 1e-3);
}
