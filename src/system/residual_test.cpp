// The test of residuals that an iteration has to pass before its last change is accepted.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/residual_test.h"

#include <algorithm>
#include <cmath>

namespace sfdae::core {

namespace {

// Rounding errors relative to the sums of terms: about fifty roundings (docs/design/steps.md, section 5).
constexpr double noise_of_sums = 1e-14;
// Rows whose residuals are at most this multiple of their noise do not count.
constexpr double clear_of_noise = 4.0;
// Negligible parts of the tolerances: with entries too large by 1e19 x is still right to 40 of them.
constexpr double near_zero_part = 1e-18;
// Relative errors of entries of a matrix with which an iteration converges as fast as with the right one.
constexpr double harmless_errors = 1e-2;

}  // namespace

double* ResidualTest::next(std::size_t count) {
  for (auto* values : {&before_, &now_, &open_}) values->resize(count);
  before_.swap(now_);
  return now_.data();
}

void ResidualTest::note() {
  has_moved_ = has_moved_ || (++count_ > 1 && now_ != before_);
  for (double r : now_) largest_ = std::max(largest_, std::fabs(r));
}

// change: sum_j |M_ij dx_j|, or 0 if unknown. A residual that was 0 and no longer is has no ratio. Comparisons are such
// that NaN fails them.
bool ResidualTest::is_small(const Allowed& allowed, std::size_t row, double change) const {
  const double r = now_[row], before = before_[row], size = std::fabs(before);
  if (r == 0.0) return true;
  const double rest = before < 0.0 ? r - before : before - r;  // (1 - rho) |r-|
  return size > 0.0 && rest >= (1.0 - allowed.largest_ratio) * size &&
         std::fabs(r * before) * allowed.norm <= allowed.tolerance * rest * std::max(size, change);
}

bool ResidualTest::is_explained(const Allowed& allowed, std::size_t row, double change) const {
  return std::fabs(now_[row]) <= harmless_errors * change || is_small(allowed, row, change);
}

bool ResidualTest::is_rounding(std::size_t row, double sum) const {
  return std::fabs(now_[row]) <= clear_of_noise * noise_of_sums * sum;
}

// The entries of a matrix, and with them the sums, may be too large by any factor: sums count up to the roundoff of the
// largest residual.
bool ResidualTest::is_zero(std::size_t row, double sum) const {
  return std::fabs(now_[row]) <= clear_of_noise * std::min(near_zero_part * sum, noise_of_sums * largest_);
}

}  // namespace sfdae::core
