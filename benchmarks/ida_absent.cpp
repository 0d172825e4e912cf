// SPDX-License-Identifier: BSD-3-Clause
// Stands in for ida_solver.cpp and ida_sparse.cpp where SUNDIALS is not installed.
#include "ida_solver.h"
#include "ida_sparse.h"

namespace sfdae_bench {

bool ida_is_available() { return false; }

SolverRun solve_with_ida(const PeerProblem&, double) { return {.failure = "SUNDIALS was not found"}; }

bool sparse_ida_is_available() { return false; }

SparsePeerRun solve_with_sparse_ida(const SparsePeer&, double, PeerMatrix) {
  SparsePeerRun run;
  run.failure = "SUNDIALS was not found";
  return run;
}

}  // namespace sfdae_bench
