// The test of residuals that an iteration has to pass before its last change is accepted.
//
// A matrix M that is too large by a factor g, such as one reused from a point where the problem was much stiffer, makes
// changes too small by g: they look converged. Residuals then decrease by the factor 1 - 1/g only. Let r- be the
// residual before a change dx, r+ the one after it, and rho_i = r+_i / r-_i in row i. The error that is left is rho_i /
// (1 - rho_i) times the part of dx that row i determines, |r-_i| / sum_j |M_ij dx_j|: rho_i near 1 means that the
// change was far too small, rho_i < 0 that it was too large.
//
// Rows are ignored if r+ is roundoff, or |r+_i| <= 1e-2 sum_j |M_ij dx_j|: F changes along dx by M dx, except for
// errors of the entries of M of that relative size [OP64] (docs/design/steps.md, section 5).
//
// [OP64] W. Oettli, W. Prager: Compatibility of approximate solution of linear equations with given error bounds for
//        coefficients and right-hand sides. Numer. Math. 6 (1964), 405-409.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

// Sums over the terms of each row, sum_j |M_ij| size_j: for the terms of the residual, where the sizes are those of the
// unknowns or their tolerances, and for the last change.
enum class RowSums { of_values, of_tolerances, of_change };

class ResidualTest {
 public:
  void begin() {
    largest_ = 0.0;
    count_ = 0;
    has_moved_ = false;
  }
  // Rows of the residuals to be evaluated next, for the caller to fill: `count` numbers.
  double* next(std::size_t count);
  // After they were filled.
  void note();
  const double* residuals() const { return now_.data(); }
  // Each row has to confirm that the change between the last two residuals, whose norm is given, leaves an error of at
  // most the tolerance, with rho_i <= largest_ratio. add(RowSums, double* rows) adds sums of terms and is called only
  // if they matter. is_trusted is false with the matrix of an initial guess: it is right where it was made, and trusted
  // until values move.
  struct Allowed {
    double tolerance, norm, largest_ratio;
  };
  template <class Add>
  bool allows(const Allowed& allowed, bool is_trusted, Add add) {
    const QuietArithmetic quiet;  // entries of the matrix of an initial guess may be so large that sums overflow
    std::fill(open_.begin(), open_.end(), 0.0);
    if (!leaves_open([&](std::size_t i, double) { return is_small(allowed, i, 0.0); })) return true;
    if (is_trusted || !has_moved_) {
      add(RowSums::of_values, open_.data());
      if (!leaves_open([&](std::size_t i, double sum) { return is_rounding(i, sum); })) return true;
    }
    add(RowSums::of_change, open_.data());
    if (!leaves_open([&](std::size_t i, double sum) { return is_explained(allowed, i, sum); })) return true;
    add(RowSums::of_tolerances, open_.data());
    return !leaves_open([&](std::size_t i, double sum) { return is_zero(i, sum); });
  }

 private:
  static constexpr double settled = -std::numeric_limits<double>::infinity();
  // True if some row has been settled neither by settles(row, its sum) nor by an earlier call. Sums that overflow are
  // ignored.
  template <class Settles>
  bool leaves_open(Settles settles) {
    bool any = false;
    for (std::size_t i = 0; i < now_.size(); ++i) {
      const bool is_open = open_[i] != settled && !(open_[i] < HUGE_VAL && settles(i, open_[i]));
      open_[i] = is_open ? 0.0 : settled;
      any = any || is_open;
    }
    return any;
  }
  bool is_small(const Allowed& allowed, std::size_t row, double change) const;
  bool is_explained(const Allowed& allowed, std::size_t row, double change) const;
  bool is_rounding(std::size_t row, double sum) const;
  bool is_zero(std::size_t row, double sum) const;

  std::vector<double> before_, now_;
  std::vector<double> open_;  // sums of rows, or `settled` where a row allows the change
  double largest_ = 0.0;      // of all residuals since begin()
  int count_ = 0;             // of residuals since then
  bool has_moved_ = false;    // the values since then
};

}  // namespace sfdae::core
