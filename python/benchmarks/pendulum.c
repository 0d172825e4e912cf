/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The pendulum of overhead.py: method, tolerance, number of outputs and end are the arguments; prints the processor
 * seconds of the whole solve, creation included, and x at the end. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <sfdae/sfdae.h>

static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression one = sfdae_number(1), two = sfdae_number(2), g = sfdae_parameter(record, "g", 9.81);
  (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(xdot[1], x[3]);
  F[2] = sfdae_add(xdot[2], sfdae_multiply(sfdae_multiply(two, x[0]), x[4]));
  F[3] = sfdae_add(sfdae_add(xdot[3], sfdae_multiply(sfdae_multiply(two, x[1]), x[4])), g);
  F[4] = sfdae_subtract(sfdae_add(sfdae_power(x[0], two), sfdae_power(x[1], two)), one);
  return 0;
}

int main(int argc, char** argv) {
  double x[5] = {0.6, -0.8, 0, 0, 0}, xdot[5], t = 0, end;
  struct timespec before, after;
  sfdae_nonlinear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  int k, outputs, status;
  if (argc != 5) return 2;
  outputs = atoi(argv[3]);
  end = atof(argv[4]);
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &before);
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  problem.num_equations = problem.num_unknowns = 5;
  problem.equations = equations;
  options.method = atoi(argv[1]);
  options.rtol = options.atol = atof(argv[2]);
  options.use_stop_time = 1;
  options.stop_time = end;
  status = sfdae_create_nonlinear(&solver, &problem, &options);
  if (status >= 0) status = sfdae_start(solver, 0, end, x, xdot);
  for (k = 1; k <= outputs && status >= 0; k++)
    status = sfdae_advance(solver, k == outputs ? end : end * k / outputs, &t, x, xdot);
  sfdae_destroy(&solver);
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &after);
  printf("%.9f", (double)(after.tv_sec - before.tv_sec) + 1e-9 * (double)(after.tv_nsec - before.tv_nsec));
  for (k = 0; k < 5; k++) printf(" %.17g", x[k]);
  printf("\n");
  return status < 0;
}
