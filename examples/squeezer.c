/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Andrews' squeezing mechanism as a multibody system, 14 angles and velocities, 6 multipliers:
 *
 *     M(q) v' = f(q, v) - g_q(q)^T lambda,   0 = g(q)
 *
 * Strangeness index 2 (differentiation index 3), one degree of freedom. M, f, g and g_q are callbacks, see
 * squeezer_model.h; the second derivative of g that the hidden constraints need is left to the library. Writes the
 * angles to squeezer.csv, which squeezer.gp draws. */
#include <stdio.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "squeezer_model.h"

int main(void) {
  sfdae_multibody_problem problem;
  sfdae_options options;
  sfdae_multibody_report report;
  sfdae_statistics statistics;
  sfdae_solver* solver = NULL;
  FILE* csv = fopen("squeezer.csv", "w");
  double t = 0, x[20] = {0}, error = 0, violation = 0;
  int k, i, status;

  sfdae_multibody_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  sfdae_multibody_report_init(&report, sizeof report);
  sfdae_statistics_init(&statistics, sizeof statistics);
  problem.num_positions = 7, problem.num_constraints = 6;
  problem.mass = mass, problem.forces = forces;
  problem.constraints = constraints, problem.constraint_jacobian = constraint_jacobian;
  options.rtol = options.atol = 1e-9;
  options.method = SFDAE_METHOD_RADAU;
  memcpy(x, angles_at_start, sizeof angles_at_start);

  status = sfdae_create_multibody(&solver, &problem, &options);
  if (status >= 0) status = sfdae_start(solver, 0, 0.03, x, NULL);
  if (csv) fputs("t,beta,theta,gamma,phi,delta,omega,epsilon\n", csv);
  for (k = 0; k <= 300 && status >= 0; k++) {
    double g[6];
    if (k > 0) status = sfdae_advance(solver, k * 1e-4, &t, x, NULL);
    if (csv) fprintf(csv, "%g,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n", t, x[0], x[1], x[2], x[3], x[4], x[5], x[6]);
    if (k % 50 == 0) printf("t = %5.3f   beta %9.6f   gamma %9.6f   force %10.4f\n", t, x[0], x[2], x[14]);
    constraints(t, x, g, NULL);
    for (i = 0; i < 6; i++) violation = fmax(violation, fabs(g[i]));
  }
  for (i = 0; i < 7; i++) error = fmax(error, fabs(x[i] - angles_at_end[i]));
  sfdae_get_multibody_report(solver, &report);
  sfdae_get_statistics(solver, &statistics);
  printf("%s %s\n%ld steps, %d degree of freedom; error %.1e, constraints violated by %.1e\n",
         sfdae_status_name(status), sfdae_message(solver), statistics.steps, report.degrees_of_freedom, error,
         violation);
  if (csv) fclose(csv);
  sfdae_destroy(&solver);
  return !(status >= 0 && report.degrees_of_freedom == 1 && error < 1e-6 && violation < 1e-13);
}
