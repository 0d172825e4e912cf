// x' of the solution of a linear problem through a consistent x: from the derivative array of level mu + 1, or by
// finite differences of the constraints. All x are those of scaled unknowns.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/arena.h"
#include "linear/linear_point.h"
#include "problem/linear_problem.h"

namespace sfdae::core {

class LinearSystem;

// A point and the result of the analysis with these settings.
struct AnalyzedPoint {
  const AnalysisSettings& settings;
  const IndexAnalysis& analysis;
  const LinearPoint& point;
};

// Memory for the derivative array of level mu + 1.
struct NextLevel {
  TaylorData& data;
  Arena& arena;
};

// The free directions held. False if the derivative array does not determine x', or is not available. Throws Failure
// for requests to stop.
bool derivative_from_array(LinearProblem& problem, const AnalyzedPoint& at, const double* x, double* xdot,
                           NextLevel next);

// The part of x' that A2 x + f2 = 0 determines, orthogonal to T2, from points near the current one in the given
// direction. The current point is the same afterwards. Throws Failure.
void derivative_from_differences(LinearSystem& system, const double* x, double direction, double* xdot);

}  // namespace sfdae::core
