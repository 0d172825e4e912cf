// Continuity test of algebraic solutions without differential equations (docs/design/iteration_matrices.md).
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/algebraic_course.h"

#include <algorithm>
#include <cmath>

namespace sfdae::core {

namespace {

// Deviation allowed: the largest of these parts of the recent range of a component and of its size, and so many
// tolerances. (Chosen.)
constexpr double part_of_range = 0.05, part_of_size = 1e-3, tolerances = 10.0;
// Target deviation of the next step, and limits of the growth of the step size.
constexpr double wanted_deviation = 0.3, fastest_growth = 2.0, least_growth = 0.5;

}  // namespace

double course_deviation(const TriedCourse& course, const ErrorWeights& weights) {
  double largest = 0.0;
  for (std::size_t r = 0; r < course.x.size(); ++r) {
    double low = course.x[r], high = course.x[r];
    for (int i = 0; i < course.count; ++i) {
      const double value = (*course.past[static_cast<std::size_t>(i)])[r];
      low = std::min(low, value);
      high = std::max(high, value);
    }
    const double error = std::fabs(course.x[r] - course.predicted[r]);
    const double allowed =
        std::max({part_of_range * (high - low), part_of_size * std::max(std::fabs(low), std::fabs(high)),
                  tolerances / weights.inverse()[r]});
    if (error > largest * allowed) largest = error / allowed;
  }
  return largest;
}

double course_growth(double deviation, int degree) {
  if (!(deviation > 0.0)) return fastest_growth;
  return std::clamp(std::pow(wanted_deviation / deviation, 1.0 / (degree + 1)), least_growth, fastest_growth);
}

}  // namespace sfdae::core
