// Whether x goes on as it did where no differential equation limits steps.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "integrate/error_weights.h"

namespace sfdae::core {

// So many points say how x goes on.
inline constexpr int max_course_points = 5;
// A solution that jumps where its equations do is followed: no step is refused more often than that, one after the
// other.
inline constexpr int most_course_refusals = 12;

// The points accepted last, the newest first, and a point that is tried.
struct TriedCourse {
  std::array<const std::vector<double>*, max_course_points> past{};
  int count = 0;
  const double* predicted;  // at the point tried, by the polynomial through some of them
  const std::vector<double>& x;
};

// How far x is from what was predicted, in units of what counts as the same solution: above 1 it may be another one.
double course_deviation(const TriedCourse& course, const ErrorWeights& weights);

// How much longer the next step may be, by the deviation of one that was accepted and the degree of its polynomial.
double course_growth(double deviation, int degree);

}  // namespace sfdae::core
