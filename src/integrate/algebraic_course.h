// Continuity test of algebraic solutions: limits steps if there are no differential equations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "integrate/error_weights.h"

namespace sfdae::core {

// Maximum number of points in the test.
inline constexpr int max_course_points = 5;
// Maximum of consecutive steps refused by this test, so that a solution is followed across jumps.
inline constexpr int most_course_refusals = 12;

// The last accepted points, the newest first, and the point tried.
struct TriedCourse {
  std::array<const std::vector<double>*, max_course_points> past{};
  int count = 0;
  const double* predicted;  // x at the point tried, extrapolated through some of them
  const std::vector<double>& x;
};

// Distance of x from the prediction, relative to the allowed deviation: above 1 it may be on another solution branch.
double course_deviation(const TriedCourse& course, const ErrorWeights& weights);

// Growth factor of the step size after a step with this deviation from a polynomial of this degree.
double course_growth(double deviation, int degree);

}  // namespace sfdae::core
