// Conversion of the public struct of options to those of the core.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sfdae/sfdae.h"
#include "solver/solver.h"

namespace sfdae::core {

// n: number of unknowns. The options have been checked.
SolverOptions solver_options(const sfdae_options& options, int n);

}  // namespace sfdae::core
