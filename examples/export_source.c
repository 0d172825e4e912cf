/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A model for other solvers: the pendulum, strangeness index 2, as C source of a strangeness-free system F(t, z, z')
 * = 0,
 *
 *     x0' = x2,   x1' = x3,   x2' = -x0 x4,   x3' = -x1 x4 - g,   0 = x0^2 + x1^2 - 1
 *
 * Equation 4 is differentiated twice, 0 and 1 once: 9 equations in 9 unknowns, of which 2 are states.
 * Usage: export_source [file]. Check: sizes, and that an integration goes on as if nothing had been written. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sfdae/sfdae.h>

static int pendulum(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    sfdae_expression* F, void* user) {
  const sfdae_expression g = sfdae_parameter(record, "g", 9.81);
  (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(xdot[1], x[3]);
  F[2] = sfdae_add(xdot[2], sfdae_multiply(x[0], x[4]));
  F[3] = sfdae_add(sfdae_add(xdot[3], sfdae_multiply(x[1], x[4])), g);
  F[4] = sfdae_subtract(sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1])), sfdae_number(1));
  return 0;
}

int main(int argc, char** argv) {
  double t = 0, x[5] = {0.6, -0.8, 0, 0, 0};
  sfdae_nonlinear_problem problem;
  sfdae_solver* solver = NULL;
  size_t needed = 0;
  char* text = NULL;
  int status, is_right = 0;

  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 5;
  problem.equations = pendulum;
  status = sfdae_create_nonlinear(&solver, &problem, NULL);
  if (status >= 0) status = sfdae_start(solver, t, 1, x, NULL);
  if (status >= 0) status = sfdae_export_source(solver, SFDAE_SOURCE_C, "pendulum", NULL, 0, &needed);
  if (status >= 0) text = malloc(needed);
  if (text != NULL) {
    FILE* const file = argc > 1 ? fopen(argv[1], "w") : stdout;
    status = sfdae_export_source(solver, SFDAE_SOURCE_C, "pendulum", text, needed, NULL);
    if (file != NULL) fputs(text, file);
    if (file != NULL && argc > 1) fclose(file);
    is_right = file != NULL && strstr(text, "pendulum_size = 9") != NULL && strstr(text, "pendulum_mu = 2") != NULL;
    free(text);
  }
  if (status >= 0) status = sfdae_advance(solver, 1, &t, x, NULL);
  printf("%s %s\n", sfdae_status_name(status), sfdae_message(solver));
  sfdae_destroy(&solver);
  return status >= 0 && is_right && fabs(x[0] * x[0] + x[1] * x[1] - 1) < 1e-9 ? 0 : 1;
}
