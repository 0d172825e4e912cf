// Whether residuals say that a change has solved the equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/residual_test.h"

#include <algorithm>
#include <cmath>

namespace sfdae::core {

namespace {

// Rounding errors relative to what is added up: some fifty roundings (docs/decisions/104-residuals-are-asked.md).
constexpr double noise_of_sums = 1e-14;
// Rows whose residuals are at most that many times their noise say nothing.
constexpr double clear_of_noise = 4.0;
// Parts of the tolerances that are as good as 0: with entries too large by 1e19 x is still right to 40 of them.
constexpr double near_zero_part = 1e-18;
// Relative errors of entries of a matrix with which an iteration converges as fast as with the right one.
constexpr double harmless_errors = 1e-2;

}  // namespace

double* ResidualTest::next(std::size_t count) {
  for (auto* values : {&before_, &now_, &excused_, &moved_, &sums_}) values->resize(count);
  before_.swap(now_);
  return now_.data();
}

void ResidualTest::note() {
  std::fill(excused_.begin(), excused_.end(), 0.0);
  for (std::size_t i = 0; i < now_.size(); ++i) {
    moved_[i] = std::fabs(before_[i]);
    largest_ = std::max(largest_, std::fabs(now_[i]));
  }
}

// Comparisons are such that NaN is no.
bool ResidualTest::allows(const Allowed& allowed, std::size_t row) const {
  const double r = now_[row], before = before_[row];
  if (std::fabs(r) <= excused_[row]) return true;
  const double rest = before < 0.0 ? r - before : before - r;  // (1 - rho) |r-|
  return rest >= (1.0 - allowed.largest_ratio) * std::fabs(before) &&
         std::fabs(r * before) <= allowed.error * rest * moved_[row];
}

bool ResidualTest::allows(const Allowed& allowed) const {
  for (std::size_t i = 0; i < now_.size(); ++i)
    if (!allows(allowed, i)) return false;
  return true;
}

void ResidualTest::take_change(const std::vector<double>& sums) {
  for (std::size_t i = 0; i < sums.size(); ++i) {
    moved_[i] = std::max(moved_[i], sums[i]);
    excused_[i] = harmless_errors * sums[i];
  }
}

void ResidualTest::excuse_rounding(const std::vector<double>& sums) {
  for (std::size_t i = 0; i < sums.size(); ++i)
    excused_[i] = std::max(excused_[i], clear_of_noise * noise_of_sums * sums[i]);
}

// Entries of a matrix may be too large by any factor, and so may the sums: they count up to rounding errors of the
// largest residual.
void ResidualTest::excuse_zeros(const std::vector<double>& sums) {
  for (std::size_t i = 0; i < sums.size(); ++i)
    excused_[i] += clear_of_noise * std::min(near_zero_part * sums[i], noise_of_sums * largest_);
}

}  // namespace sfdae::core
