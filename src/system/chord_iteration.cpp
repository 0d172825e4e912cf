// Criteria of a chord iteration: converged, too slow, or of no use.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/chord_iteration.h"

#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Changes below this are negligible at any rate: a billionth of the tolerances.
constexpr double negligible_correction = 1e-9;
// A matrix that needs more iterations, or contracts less, is refactored for the next point: about as much work as a new
// one for the problems of the test set.
constexpr int many_iterations = 3;
constexpr double slow_rate = 0.3;
// Before a rate is measured, the rate of the last point is used, but at least this.
constexpr double least_first_rate = 0.05;
constexpr double largest_rate = 0.99;
// Changes that stop decreasing this far below the target are rounding errors.
constexpr double far_below = 0.1;

}  // namespace

bool ChordIteration::has_converged(const ChordTarget& target, int iteration, double norm, double before) {
  const QuietArithmetic quiet;  // the ratio of a change to one that was nearly 0 overflows
  double rate = rate_;
  if (iteration > 0) {
    rate = before > 0.0 ? norm / before : 0.0;
    rate_ = iteration == 1 ? rate : std::max(rate_, rate);
  }
  is_slow_ = iteration >= many_iterations || (iteration > 0 && rate > slow_rate && norm > negligible_correction);
  if (iteration > 1 && norm <= far_below * target.tolerance) return true;
  if (iteration > 0 && rate >= 1.0) return false;
  if (iteration == 0 && target.needs_two) return norm <= negligible_correction;
  rate = std::clamp(rate, iteration == 0 ? least_first_rate : target.least_rate, largest_rate);
  return rate / (1.0 - rate) * norm <= target.tolerance || norm <= negligible_correction;
}

}  // namespace sfdae::core
