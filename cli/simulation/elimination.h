// Unknowns that equations give explicitly by others; eliminating them leaves a small system to be solved.
//
// [CK06] F. E. Cellier, E. Kofman: Continuous System Simulation. Springer, 2006, chapter 7 (sorting and tearing).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/system.h"

namespace sfdae::cli {

// variable := value, from a residual that is then satisfied.
struct SolvedUnknown {
  int variable = -1;
  Formula value = -1;
  int residual = -1;
};

// Definitions, ordered so that each needs only remaining unknowns and earlier definitions. An equation defines a
// variable if it contains it linearly with a numerical coefficient and contains no derivative; states are never
// defined. Residuals contain only roots of aliases. used: residuals that have been eliminated.
std::vector<SolvedUnknown> find_definitions(System& system, const std::vector<Residual>& residuals,
                                            const std::vector<char>& used);

// The definitions that require no tearing, that is, no choice of variables that remain unknowns.
std::vector<SolvedUnknown> find_explicit(System& system, const std::vector<Residual>& residuals,
                                         const std::vector<char>& used);

}  // namespace sfdae::cli
