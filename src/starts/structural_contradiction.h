// Where ranks of the derivative array and the structure of the equations say different things.
//
// Ranks tell what is small beside what is large, and a moment of inertia of 1e-20 kg m2 is: an array drops it, and
// values that are free are taken for determined. Where every block of the system Jacobian is regular the structure
// knows how many are free [P01].
//
// [P01] J. D. Pryce: A Simple Structural Analysis Method for DAEs. BIT 41 (2001), 364-394.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "problem/nonlinear_problem.h"
#include "reduction/index_analysis.h"
#include "system/jet.h"

namespace sfdae::core {

// What they disagree about, "" where they do not: where nothing is said against the array, or where an entry of it is
// so small beside what units of equations and unknowns suggest that it may be a rounding error of a zero
// (docs/design/scaling_and_units.md). jet: consistent. values: by the array. rank_tol: the user's, who has decided
// then.
std::string contradiction_of_structure(NonlinearProblem& problem, const Jet& jet, const CharacteristicValues& values,
                                       double rank_tol);

}  // namespace sfdae::core
