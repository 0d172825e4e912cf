// Unknowns that equations give explicitly in others, so that the system that has to be solved is small.
//
// [CK06] F. E. Cellier, E. Kofman: Continuous System Simulation. Springer, 2006, chapter 7 (sorting and tearing).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/system.h"

namespace sfdae::cli {

// variable := value, from a residual that then holds.
struct SolvedUnknown {
  int variable = -1;
  Formula value = -1;
  int residual = -1;
};

// Definitions in an order in which each needs only what remains and those before it. An equation defines a variable if
// it contains it linearly with a coefficient that is a number, and contains no derivative; states are never defined.
// Residuals contain roots of aliases alone. used: those that are no longer there.
std::vector<SolvedUnknown> find_definitions(System& system, const std::vector<Residual>& residuals,
                                            const std::vector<char>& used);

// Of these, those that need no variable to be chosen and kept; without looking for more.
std::vector<SolvedUnknown> find_explicit(System& system, const std::vector<Residual>& residuals,
                                         const std::vector<char>& used);

}  // namespace sfdae::cli
