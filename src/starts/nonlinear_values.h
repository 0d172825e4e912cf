// Consistent initial values of a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "problem/nonlinear_problem.h"
#include "reduction/index_analysis.h"
#include "starts/consistent_values.h"
#include "starts/jet_solver.h"
#include "system/jet.h"

namespace sfdae::core {

// Values that were given, and a jet near them that is consistent up to level mu.
struct ConsistentJetStart {
  const std::vector<double>& given;
  const Jet& jet;
  double rank_tol = 0.0;  // of the analysis
};

struct ConsistentJetResult {
  Jet jet;  // consistent up to level mu
  ConsistencyResult change;
  ValueChange value_change;  // of what was to stay
};

// The solver changes x in the way that is asked for, as far as one step at a time can.
void prepare(JetSolver& solver, const ConsistencyRequest& request);

// The consistent jet that is chosen for the values given as requested. Throws Failure: SFDAE_INCONSISTENT_VALUES,
// SFDAE_FIXED_VALUES, SFDAE_NO_CONSISTENT_VALUES, SFDAE_CHARACTERISTICS_CHANGED, errors of callbacks.
ConsistentJetResult choose_consistent_jet(NonlinearProblem& problem, const IndexAnalysis& analysis,
                                          const Units& units, const ConsistencyRequest& request,
                                          const ConsistentJetStart& start);

}  // namespace sfdae::core
