// Separates equations that determine discrete variables, and checks that the others match the continuous unknowns.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/system.h"

namespace sfdae::cli {

struct ImportedEquation {
  Formula left = -1, right = -1;
  Location at;
};

struct ClassifiedEquations {
  std::vector<Residual> continuous;
  std::vector<DiscreteAssignment> discrete;  // in no particular order
};

// How a variable is determined.
enum class Determined {
  elsewhere,   // a value, or a when clause
  discretely,  // an equation, at events
  continuously
};

// determined: one entry per variable. Throws ModelError if equations and unknowns do not match.
ClassifiedEquations classify(System& system, const std::vector<ImportedEquation>& equations,
                             const std::vector<Determined>& determined);

}  // namespace sfdae::cli
