// The analysis along a jet of a nonlinear problem: by norms, as residuals and rounding errors of jets look like
// values to a certificate.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "reduction/two_point_analysis.h"

namespace sfdae::core {

// Throws Failure as analyze_index does. decisions: all that were made.
IndexAnalysis analyze_along_jet(CoefficientSource& source, Place place, const AnalysisSettings& settings,
                                Arena& arena, std::vector<RankDecision>& decisions);

}  // namespace sfdae::core
