// The analysis at a point and at a second one nearby, in the units of the problem.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "reduction/index_search.h"

namespace sfdae::core {

// Point of an analysis, and the side of its second point.
struct Place {
  double t, toward;
};

struct AnalysisOutcome {
  IndexAnalysis analysis;
  // Certificates: over all decisions at both points.
  Significance significance;
  bool is_clear = true;
};

// By the ranks at t alone, if they are clear and agree with the precedent of the settings; else none.
std::optional<IndexAnalysis> analyze_by_precedent(const SearchTask& task, Place place);

// Throws Failure: SFDAE_INDEX_TOO_HIGH; SFDAE_CHARACTERISTICS_CHANGED if t is an exceptional point; SFDAE_RANK_UNCLEAR,
// but not for certificates, which report it in the outcome.
AnalysisOutcome analyze_at_two_points(const SearchTask& task, Place place);

}  // namespace sfdae::core
