// Choice of order and step size for BDF.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/step_control.h"

#include <algorithm>
#include <cmath>

namespace sfdae::core {

namespace {

// Numbers without a comment are those of DASSL [BCP96, 5.2].

// Measured: 2 (as in the literature) wastes steps with the mapped error norm, 1.5 does not.
constexpr double error_safety = 1.5;
// Replaces an error of zero.
constexpr double least_positive_estimate = 1e-30;
// Added to errors, so that step sizes are limited even without an error.
constexpr double error_offset = 1e-4;
// Upper limit of the count of steps at one order: a checkpoint stores small integers.
constexpr int most_steps_at_order = 1000;
// The size of the first step after a failure follows from its measured error, for half the error allowed, 0.7^2, but is
// at least this part of the failed one (docs/design/error_control.md; both chosen).
constexpr double first_step_safety = 0.7, shortest_first_step = 1e-6;
// The error of order 1 in units of its local term.
constexpr double error_of_euler = 0.5;

}  // namespace

void StepControl::start(int max_order) {
  max_order_ = max_order;
  order_ = 1;
  starting_ = true;
  first_step_ = true;
  steps_at_order_ = 0;
  failures_ = 0;
}

bool can_lower_order(int k, const LocalTerms& terms) {
  return k * terms.of_order[k - 1] <= (k + 1) * terms.of_order[k];
}

// The order is lowered if the terms do not fall: near the imaginary axis this is the safe policy [BCP96].
int StepControl::lower_order(const LocalTerms& terms) const {
  const int k = order_;
  const double* term = terms.of_order;
  if (k == 2 && 2.0 * term[1] <= 0.5 * 3.0 * term[2]) return 1;
  if (k > 2 && can_lower_order(k, terms) && (k - 1) * term[k - 2] <= (k + 1) * term[k]) return k - 1;
  return k;
}

double StepControl::accepted(double h, const LocalTerms& terms) {
  failures_ = 0;
  first_step_ = false;
  steps_at_order_ = std::min(steps_at_order_ + 1, most_steps_at_order);
  const double* term = terms.of_order;
  const int k = order_;
  const int lowered = lower_order(terms);
  if (starting_) {
    if (lowered < k || k == max_order_) {
      starting_ = false;
    } else {
      ++order_;
      steps_at_order_ = 0;
      return 2.0 * h;
    }
  }
  int next = k;
  if (lowered < k) {
    next = k - 1;
  } else if (k < max_order_ && term[k + 1] >= 0.0 && steps_at_order_ >= k + 1) {
    const double here = (k + 1) * term[k], above = (k + 2) * term[k + 1];
    if (k == 1) {
      if (above < 0.5 * here) next = 2;
    } else if (k * term[k - 1] <= std::min(here, above)) {
      next = k - 1;
    } else if (above < here) {
      next = k + 1;
    }
  }
  const double estimate = std::max(term[next], least_positive_estimate);
  if (next != k) steps_at_order_ = 0;
  order_ = next;
  const double ratio = std::pow(error_safety * estimate + error_offset, -1.0 / (next + 1));
  if (ratio >= 2.0) return 2.0 * h;
  if (ratio <= 1.0) return h * std::clamp(ratio, 0.5, 0.9);
  return h;
}

double StepControl::rejected(double h, const LocalTerms& terms, bool finite) {
  ++failures_;
  if (first_step_ && finite) {
    // Only this estimate is known: it has order 1, and gives the right size.
    const double error = error_of_euler * std::max(terms.of_order[1], least_positive_estimate);
    return h * std::clamp(first_step_safety / std::sqrt(error), shortest_first_step, 0.5);
  }
  starting_ = false;
  steps_at_order_ = 0;
  if (failures_ == 1) {
    order_ = finite ? lower_order(terms) : order_;
    if (!finite) return 0.25 * h;
    const double estimate = std::max(terms.of_order[order_], least_positive_estimate);
    return h * std::clamp(0.9 * std::pow(2.0 * estimate + error_offset, -1.0 / (order_ + 1)), 0.25, 0.9);
  }
  order_ = failures_ == 2 && finite ? lower_order(terms) : 1;
  return 0.25 * h;
}

double StepControl::failed(double h) {
  ++failures_;
  starting_ = false;
  steps_at_order_ = 0;
  return 0.25 * h;
}

}  // namespace sfdae::core
