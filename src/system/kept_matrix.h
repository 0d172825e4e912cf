// Matrices of steps that are kept while c, of x' = c x + ..., changes little
// (docs/design/iteration_matrices.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace sfdae::core {

// What the contraction is at best with the matrix for another c.
inline double deviation_of(double c, double kept) { return std::fabs(c - kept) / std::fabs(c + kept); }

// A matrix whose c deviates by more is made anew: c has changed by a factor of 3/5 or 5/3 (that of DASSL and IDA).
inline constexpr double largest_deviation = 0.25;
// Deviations that slow iterations do not come from.
inline constexpr double harmless_deviation = 0.05;

// Iterations that it takes more than the matrix for c itself: what iterations have to gain from the predictor on, and
// gain in one with the right matrix, as a rule, is that of the problems of benchmarks/index0_cost.cpp.
inline double iterations_wasted(double deviation) {
  constexpr double usual_gain = 300.0, usual_rate = 0.03;
  if (deviation <= usual_rate) return 0.0;
  return std::log(usual_gain) * (1.0 / std::log(1.0 / deviation) - 1.0 / std::log(1.0 / usual_rate));
}

}  // namespace sfdae::core
