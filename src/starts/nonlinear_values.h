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
  ValueChange value_change;  // of values that were to stay
};

// Lets the solver change x as requested, as far as one step at a time can.
void prepare(JetSolver& solver, const ConsistencyRequest& request);

// The consistent jet chosen as requested for the given values. Throws Failure: SFDAE_INCONSISTENT_VALUES,
// SFDAE_FIXED_VALUES, SFDAE_NO_CONSISTENT_VALUES, SFDAE_CHARACTERISTICS_CHANGED, errors of callbacks.
ConsistentJetResult choose_consistent_jet(NonlinearProblem& problem, const IndexAnalysis& analysis,
                                          const Units& units, const ConsistencyRequest& request,
                                          const ConsistentJetStart& start);

}  // namespace sfdae::core
