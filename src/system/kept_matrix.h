// Reuse of step matrices while c, of x' = c x + ..., changes little (docs/design/iteration_matrices.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace sfdae::core {

// Best possible convergence rate with the matrix for another c.
inline double deviation_of(double c, double kept) { return std::fabs(c - kept) / std::fabs(c + kept); }

// A matrix whose c deviates by more is refactored: c has changed by a factor of 3/5 or 5/3 (as in DASSL and IDA).
inline constexpr double largest_deviation = 0.25;
// Smaller deviations are not the cause of slow iterations.
inline constexpr double harmless_deviation = 0.05;

// Additional iterations compared with the matrix for c itself. The error that iterations have to reduce from the
// predictor on, and their usual gain per iteration with the right matrix, are those of the problems of
// benchmarks/index0_cost.cpp.
inline double iterations_wasted(double deviation) {
  constexpr double usual_gain = 300.0, usual_rate = 0.03;
  if (deviation <= usual_rate) return 0.0;
  return std::log(usual_gain) * (1.0 / std::log(1.0 / deviation) - 1.0 / std::log(1.0 / usual_rate));
}

}  // namespace sfdae::core
