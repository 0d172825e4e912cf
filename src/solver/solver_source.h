// Source text of a solver's equations at its current point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "extension/model_source.h"
#include "solver/solver.h"

namespace sfdae::core {

// Throws Failure.
std::string source_of(Solver& solver, Language language, const char* name);

}  // namespace sfdae::core
