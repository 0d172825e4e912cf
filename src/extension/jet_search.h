// Common parts of searches for consistent jets: sizes of changes, and convergence tests.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "linalg/index.h"
#include "linalg/rank.h"

namespace sfdae::core {

// Units of changes: sizes of x, n values, far below which changes do not matter, and the equations' own unit of time,
// so that results do not depend on that of the user.
struct SearchUnits {
  std::vector<double> sizes;
  double time = 1.0;
  // Units of columns x_j^(order), by time alone.
  template <class Columns>
  std::vector<double> of(const Columns& columns) const {
    std::vector<double> units;
    units.reserve(columns.size());
    for (const auto& column : columns) units.push_back(std::pow(time, -column.order));
    return units;
  }
};

inline void scale_columns(const std::vector<int>& column, const std::vector<double>& units,
                          std::vector<double>& values) {
  for (std::size_t e = 0; e < values.size(); ++e) values[e] *= units[index(column[e])];
}

// Change in one iteration: the largest of x, in units of x or its tolerance, and the largest relative one of
// derivatives.
class JetChange {
 public:
  void add(int order, double dx, double value, double size) {
    const double before = std::fabs(value - dx), scale = std::max(std::fabs(value), before);
    is_finite_ = is_finite_ && std::isfinite(value);
    if (dx == 0.0 || !is_finite_) return;
    double& largest = order == 0 ? of_x_ : of_derivatives_;
    largest = std::max(largest, std::fabs(dx) / (order == 0 ? std::max(scale, size) : scale));
  }
  bool is_finite() const { return is_finite_; }
  bool is_negligible() const { return std::max(of_x_, of_derivatives_) <= 4.0 * unit_roundoff; }
  bool is_small() const { return of_x_ <= small && of_derivatives_ <= small; }
  double of_x() const { return of_x_; }
  double largest() const { return std::max(of_x_, of_derivatives_); }
  static constexpr double small = 1e-8;

 private:
  double of_x_ = 0.0, of_derivatives_ = 0.0;
  bool is_finite_ = true;
};

// Relative to the sum of terms, residuals that are pure roundoff.
inline constexpr double rounding_residual = 1e-14;

// Convergence test: a search ends when nothing changes, or when changes are roundoff: those of x are small, and
// residuals no longer decrease.
class SearchProgress {
 public:
  // relative: the largest residual relative to the sum of its terms.
  bool has_ended(const JetChange& change, double residual, double relative) {
    constexpr double near_rounding = 1e-12;
    const bool stands = iterations_ > 0 && residual >= 0.1 * residual_ &&
                        (residual <= JetChange::small * largest_ || relative <= near_rounding);
    is_stuck_ = iterations_ > 2 && residual >= 0.1 * residual_ && !change.is_small();
    const bool is_small = change.is_small() && iterations_ > 0 && change.of_x() >= 0.1 * before_;
    largest_ = std::max(largest_, residual);
    residual_ = residual;
    before_ = change.of_x();
    ++iterations_;
    if (change.is_negligible() || is_small) return true;
    // Nothing can be better, however much roundoff moves derivatives, which hardly matter. If it moves x, matrices are
    // nearly singular, and the point is one of those where entries that vanish at all solutions are roundoff.
    const bool is_rounding = iterations_ > 2 && relative <= rounding_residual;
    return change.of_x() <= JetChange::small && (is_rounding || stands);
  }

  // Residuals no longer decrease: continuing is useless if every step should be as good as the last.
  bool is_stuck() const { return is_stuck_; }

 private:
  int iterations_ = 0;
  bool is_stuck_ = false;
  double residual_ = 0.0, largest_ = 0.0, before_ = 0.0;
};

// Largest absolute entry; HUGE_VAL if one is not finite.
inline double largest_entry(const std::vector<double>& v) {
  double largest = 0.0;
  for (double entry : v) largest = std::isfinite(entry) ? std::max(largest, std::fabs(entry)) : HUGE_VAL;
  return largest;
}

// Sum of |derivative| |unknown| for each row; x: of column c.
template <class Value>
void sum_rows(const std::vector<int>& first, const std::vector<int>& column, const std::vector<double>& values,
              Value x, std::vector<double>& sums) {
  sums.assign(first.size() - 1, 0.0);
  for (std::size_t i = 0; i < sums.size(); ++i)
    for (int e = first[i]; e < first[i + 1]; ++e) sums[i] += std::fabs(values[index(e)] * x(column[index(e)]));
}

// Largest residual relative to the sum of its row, and the largest of the residuals that are more than `ignored`
// relative to it. HUGE_VAL: not finite.
struct ResidualSizes {
  double relative = 0.0, largest = 0.0;
};
inline ResidualSizes residual_sizes(const std::vector<double>& sums, const std::vector<double>& r, double ignored) {
  ResidualSizes sizes;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (r[i] == 0.0) continue;
    if (!std::isfinite(r[i]) || !std::isfinite(sums[i])) return {HUGE_VAL, HUGE_VAL};
    const double relative = sums[i] > 0.0 ? std::fabs(r[i]) / sums[i] : 1.0;
    sizes.relative = std::max(sizes.relative, relative);
    if (relative > ignored) sizes.largest = std::max(sizes.largest, std::fabs(r[i]));
  }
  return sizes;
}

// Scales each row by its largest derivative; factors: residuals have to be multiplied by these, too.
inline void equilibrate_rows(const std::vector<int>& first, std::vector<double>& values,
                             std::vector<double>& factors) {
  factors.assign(first.size() - 1, 1.0);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    double largest = 0.0;
    for (int e = first[i]; e < first[i + 1]; ++e) largest = std::max(largest, std::fabs(values[index(e)]));
    if (largest > 0.0) factors[i] = 1.0 / largest;
    for (int e = first[i]; e < first[i + 1]; ++e) values[index(e)] *= factors[i];
  }
}

}  // namespace sfdae::core
