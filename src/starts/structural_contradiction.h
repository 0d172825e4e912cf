// Contradictions between ranks of the derivative array and the structural analysis.
//
// Ranks depend on relative sizes: the derivative array neglects a moment of inertia of 1e-20 kg m2, and free values are
// taken for determined. If every block of the system Jacobian is nonsingular, the structural analysis gives the number
// of free values [P01].
//
// [P01] J. D. Pryce: A Simple Structural Analysis Method for DAEs. BIT 41 (2001), 364-394.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "problem/nonlinear_problem.h"
#include "reduction/index_analysis.h"
#include "system/jet.h"

namespace sfdae::core {

// Describes the contradiction; "" if there is none, or if an entry of the derivative array is so small for the units of
// equations and unknowns that it may be a rounding error of a zero (docs/design/scaling_and_units.md). jet: consistent.
// values: from the derivative array. rank_tol: if positive, the user has decided.
std::string contradiction_of_structure(NonlinearProblem& problem, const Jet& jet, const CharacteristicValues& values,
                                       double rank_tol);

}  // namespace sfdae::core
