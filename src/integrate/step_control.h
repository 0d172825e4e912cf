// Choice of order and step size for BDF, after DASSL.
//
// [BCP96] K. E. Brenan, S. L. Campbell, L. R. Petzold: Numerical Solution of Initial-Value Problems in
//         Differential-Algebraic Equations. SIAM, 1996, chapter 5.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/archive.h"

namespace sfdae::core {

inline constexpr int max_bdf_order = 5;

// Scaled norms of the local terms of the Taylor series: terms[q] ~ h^(q+1) |w^(q+1)|, q = order - 2 .. order + 1;
// negative if unknown.
struct LocalTerms {
  double of_order[max_bdf_order + 2];
};

// True if the term of order k - 1 permits lowering the order k > 2, whatever that of order k - 2.
bool can_lower_order(int k, const LocalTerms& terms);

class StepControl {
 public:
  // The first step has order 1; order and step size rise with every step until terms stop falling.
  void start(int max_order);

  int order() const { return order_; }
  void set_max_order(int max_order) {
    max_order_ = max_order;
    order_ = order_ < max_order ? order_ : max_order;
  }
  // True if the terms of this step may raise the order of the next one, if it is accepted; in the starting phase the
  // order rises whatever they are.
  bool may_raise_order() const { return !starting_ && order_ < max_order_ && steps_at_order_ >= order_; }
  // The next step size after an accepted step of size h.
  double accepted(double h, const LocalTerms& terms);
  // The next step size after a step of size h failed the error test.
  double rejected(double h, const LocalTerms& terms, bool finite);
  // The next step size after the point could not be evaluated or the matrix was singular.
  double failed(double h);
  // The order is limited by the number of points known.
  void limit_order(int points) { order_ = order_ < points - 1 ? order_ : points - 1; }
  int failures_in_a_row() const { return failures_; }
  void archive(Archive& archive) {
    archive.small(order_, starting_, first_step_, steps_at_order_, failures_);
    if (archive.is_reading() && (order_ < 1 || order_ > max_bdf_order)) throw DamagedArchive();
  }

 private:
  int lower_order(const LocalTerms& terms) const;

  int max_order_ = max_bdf_order;
  int order_ = 1;
  bool starting_ = true;
  bool first_step_ = true;  // none accepted yet
  int steps_at_order_ = 0;
  int failures_ = 0;
};

}  // namespace sfdae::core
