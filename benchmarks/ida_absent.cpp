// SPDX-License-Identifier: BSD-3-Clause
// Stands in for ida_solver.cpp where SUNDIALS is not installed.
#include "ida_solver.h"

namespace sfdae_bench {

bool ida_is_available() { return false; }

SolverRun solve_with_ida(const PeerProblem&, double) { return {.failure = "SUNDIALS was not found"}; }

}  // namespace sfdae_bench
