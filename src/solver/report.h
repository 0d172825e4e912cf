// The diagnostics report of a solver as text.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "solver/solver.h"

namespace sfdae::core {

// about_modes: of the hybrid system that the solver is a mode of; empty: of none.
std::string report_of(const Solver& solver, const std::string& about_modes);
// The breakpoints that an integration under way is going to meet, and the jump crossed last; empty where there are
// none.
std::string breakpoints_report(const Solver& solver);
// The work of the adjoint for `count` parameters.
std::string report_of(int count, const AdjointWork& work);

}  // namespace sfdae::core
