// SPDX-License-Identifier: BSD-3-Clause
// One integration of recorded equations with the library itself.
#pragma once

#include <optional>

#include "ida_solver.h"
#include "test_set/test_problem.h"

namespace sfdae_bench {

enum class Method { bdf, radau };

// rtol = atol = tol, the equations as they are: nothing is reduced by hand. No value: the library cannot do it yet.
template <class Equations>
std::optional<SolverRun> solve_with_sfdae(const sfdae_test::TestProblem&, const Equations&, Method, double) {
  return std::nullopt;
}

}  // namespace sfdae_bench
