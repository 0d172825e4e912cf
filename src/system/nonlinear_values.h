// Consistent initial values of a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "reduction/index_analysis.h"
#include "system/consistent_jet.h"
#include "system/consistent_values.h"

namespace sfdae::core {

struct ConsistentJetResult {
  Jet jet;  // consistent up to level mu
  ConsistencyResult change;
};

// From a jet near x that is consistent up to level mu to the one that is chosen as requested. Throws Failure:
// SFDAE_INCONSISTENT_VALUES, SFDAE_FIXED_VALUES, SFDAE_NO_CONSISTENT_VALUES, SFDAE_CHARACTERISTICS_CHANGED, errors
// of callbacks.
ConsistentJetResult choose_consistent_jet(NonlinearProblem& problem, const IndexAnalysis& analysis,
                                          const Units& units, const ConsistencyRequest& request, const Jet& start,
                                          const std::vector<double>& x);

}  // namespace sfdae::core
