/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A pendulum of length and mass 1 in Cartesian coordinates, 2 x5 the force in the rod:
 *
 *     x1' = x3,   x2' = x4,   x3' = -2 x1 x5,   x4' = -2 x2 x5 - g,   0 = x1^2 + x2^2 - 1
 *
 * Strangeness index 2 (differentiation index 3), d = 2, a = 3. The equations are given as they are; the library
 * finds the hidden constraints x1 x3 + x2 x4 = 0 and x3^2 + x4^2 = g x2 + 2 x5 and keeps them. The energy is an
 * invariant. */
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression one = sfdae_number(1), two = sfdae_number(2), g = sfdae_parameter(record, "g", 9.81);
  const sfdae_expression force = sfdae_multiply(two, x[4]);
  (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(xdot[1], x[3]);
  F[2] = sfdae_add(xdot[2], sfdae_multiply(x[0], force));
  F[3] = sfdae_add(sfdae_add(xdot[3], sfdae_multiply(x[1], force)), g);
  F[4] = sfdae_subtract(sfdae_add(sfdae_power(x[0], two), sfdae_power(x[1], two)), one);
  return 0;
}

int main(void) {
  sfdae_nonlinear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  double t = 0, x[5] = {0.6, -0.8, 0, 0, 0}, energy = 0, violation = 0; /* at rest; 0 stands for the force */
  int k, status;

  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  problem.num_equations = problem.num_unknowns = 5;
  problem.equations = equations;
  options.rtol = options.atol = 1e-9;
  options.method = SFDAE_METHOD_RADAU;
  status = sfdae_create_nonlinear(&solver, &problem, &options);
  if (status >= 0) status = sfdae_start(solver, 0, 10, x, NULL);
  for (k = 1; k <= 10 && status >= 0; k++) {
    status = sfdae_advance(solver, k, &t, x, NULL);
    energy = fmax(energy, fabs((x[2] * x[2] + x[3] * x[3]) / 2 + 9.81 * (x[1] + 0.8)));
    violation = fmax(violation, fabs(x[0] * x[0] + x[1] * x[1] - 1));
    violation = fmax(violation, fabs(x[0] * x[2] + x[1] * x[3]));
    violation = fmax(violation, fabs(x[2] * x[2] + x[3] * x[3] - 9.81 * x[1] - 2 * x[4]));
    printf("t = %4.1f   position (%9.6f, %9.6f)   force in the rod %9.6f\n", t, x[0], x[1], 2 * x[4]);
  }
  printf("%s %s\nerror of the energy %.1e, of the constraints %.1e\n", sfdae_status_name(status),
         sfdae_message(solver), energy, violation);
  sfdae_destroy(&solver);
  return !(status >= 0 && t == 10 && energy < 1e-6 && violation < 1e-11);
}
