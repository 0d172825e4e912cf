// The analysis at a point and at another one nearby, in the units that the problem has.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "reduction/index_search.h"

namespace sfdae::core {

// Where an analysis is made, and on which side its other point is.
struct Place {
  double t, toward;
};

struct AnalysisOutcome {
  IndexAnalysis analysis;
  // Of certificates: all decisions at both points.
  Significance significance;
  bool is_clear = true;
};

// By the ranks at t alone, where they are clear and those of the precedent of the settings; else none.
std::optional<IndexAnalysis> analyze_by_precedent(const SearchTask& task, Place place);

// Throws Failure: SFDAE_INDEX_TOO_HIGH; SFDAE_CHARACTERISTICS_CHANGED if t is an exceptional point; SFDAE_RANK_UNCLEAR,
// but not for certificates, which say so in the outcome.
AnalysisOutcome analyze_at_two_points(const SearchTask& task, Place place);

}  // namespace sfdae::core
