// Objects of the theory for a nonlinear problem at a jet: derivative array, projectors, and jets for them.
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006, ch. 4.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/nonlinear_problem.h"
#include "reduction/derivative_array.h"
#include "reduction/index_analysis.h"
#include "system/jet.h"

namespace sfdae::core {

// The jet with F_level = 0 whose t and x are those of `start`, and whose derivatives are near those of `start`. Throws
// Failure: errors of callbacks, SFDAE_INCONSISTENT_VALUES if there is none.
Jet jet_through(NonlinearProblem& problem, const Units& units, const Jet& start, int level);

// Throws SFDAE_INCONSISTENT_VALUES: there is no jet of this level through x.
[[noreturn]] void throw_inconsistent_jet(double t, int level);

// Both throw Failure. The jet need not satisfy F_level = 0.
DerivativeArray derivative_array(NonlinearProblem& problem, const Jet& jet, int level);
// Projectors of the array of level mu. known.v_hat -1: as many redundant rows as are found.
Projectors projectors(NonlinearProblem& problem, const Units& units, const IndexAnalysis& known,
                      const AnalysisSettings& settings, const Jet& jet);

// M dy = N dx + g at the jet, for the array of a linear problem that stands for M y = N x + g.
void move_to_jet(const Jet& jet, DerivativeArray& array);

}  // namespace sfdae::core
