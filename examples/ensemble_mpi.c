/* SPDX-License-Identifier: BSD-3-Clause
 *
 * An ensemble divided among the processes of MPI: each solves its part with the same call, by one thread. A chemical
 * reaction with rates k1, k2 and conserved mass, C given by A + B + C = 1,
 *
 *     A' = -k1 A,   B' = k1 A - k2 B,   A = e^(-k1 t),   B = k1 (e^(-k1 t) - e^(-k2 t)) / (k2 - k1),   A(0) = 1
 *
 *     mpirun -n 4 ensemble_mpi
 */
#include <math.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

#include <sfdae/sfdae.h>

enum { ALL = 240, N = 3, P = 2 };

static int reaction(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    sfdae_expression* F, void* user) {
  const sfdae_expression k1 = sfdae_parameter(record, "k1", 1), k2 = sfdae_parameter(record, "k2", 2);
  const sfdae_expression first = sfdae_multiply(k1, x[0]), second = sfdae_multiply(k2, x[1]);
  (void)t, (void)user;
  F[0] = sfdae_add(xdot[0], first);
  F[1] = sfdae_add(sfdae_subtract(xdot[1], first), second);
  F[2] = sfdae_subtract(sfdae_add(sfdae_add(x[0], x[1]), x[2]), sfdae_number(1));
  return 0;
}

int main(int argc, char** argv) {
  static const char* const names[P] = {"k1", "k2"};
  static double parameters[P * ALL], x0[N * ALL], x[N * ALL], all[N * ALL];
  static int statuses[ALL];
  const double tend = 1.5;
  int rank, ranks, i, status, failed;
  double worst = 0;
  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  if (ALL % ranks != 0) MPI_Abort(MPI_COMM_WORLD, 2);
  const int mine = ALL / ranks, first = mine * rank;
  for (i = 0; i < ALL; i++) parameters[P * i] = 1 + 0.01 * i, parameters[P * i + 1] = 0.5 + 0.001 * i, x0[N * i] = 1;

  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = N;
  problem.equations = reaction;
  sfdae_solver* solver;
  status = sfdae_create_nonlinear(&solver, &problem, NULL);
  sfdae_ensemble ensemble;
  sfdae_ensemble_init(&ensemble, sizeof ensemble);
  ensemble.num_instances = mine;
  ensemble.num_parameters = P, ensemble.parameter_names = names, ensemble.parameters = parameters + P * first;
  ensemble.x0 = x0 + N * first;
  ensemble.num_times = 1, ensemble.times = &tend;
  ensemble.num_threads = 1;
  sfdae_ensemble_results results;
  sfdae_ensemble_results_init(&results, sizeof results);
  results.x = x, results.statuses = statuses;
  if (status == SFDAE_OK) status = sfdae_solve_ensemble(solver, &ensemble, &results);
  failed = status != SFDAE_OK;
  if (failed) printf("rank %d: %s\n", rank, sfdae_message(solver));
  sfdae_destroy(&solver);

  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Gather(x, N * mine, MPI_DOUBLE, all, N * mine, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  for (i = 0; rank == 0 && i < ALL; i++) {
    const double k1 = parameters[P * i], k2 = parameters[P * i + 1], A = exp(-k1 * tend),
                 B = k1 * (A - exp(-k2 * tend)) / (k2 - k1);
    worst = fmax(worst, fmax(fabs(all[N * i] - A), fabs(all[N * i + 1] - B)));
  }
  if (rank == 0) printf("%d reactions by %d processes, worst error %.1e\n", ALL, ranks, worst);
  MPI_Finalize();
  return !failed && worst < 1e-4 ? EXIT_SUCCESS : EXIT_FAILURE;
}
