// Which equations determine discrete variables, and whether there are as many others as continuous unknowns.
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

// What determines a variable.
enum class Determined {
  elsewhere,   // a value, or a when clause
  discretely,  // an equation, at events
  continuously
};

// determined: of every variable. Throws ModelError where equations and unknowns do not fit.
ClassifiedEquations classify(System& system, const std::vector<ImportedEquation>& equations,
                             const std::vector<Determined>& determined);

}  // namespace sfdae::cli
