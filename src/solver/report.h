// Diagnostics report of a solver as text.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "solver/solver.h"

namespace sfdae::core {

// about_modes: report on the hybrid system of which the solver is a mode; empty: none.
std::string report_of(const Solver& solver, const std::string& about_modes);
// The breakpoints ahead of the current integration, and the last jump; empty if there are none.
std::string breakpoints_report(const Solver& solver);
// Work of the adjoint for `count` parameters.
std::string report_of(int count, const AdjointWork& work);

}  // namespace sfdae::core
