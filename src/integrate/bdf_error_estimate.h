// Error estimate of BDF: differences between w and its predictors of several degrees.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/bdf_step.h"

namespace sfdae::core {

// What differences to predictors say of the errors of x, or of what goes along with it.
class ErrorMap {
 public:
  virtual ~ErrorMap() = default;
  // Columns, `count` of them.
  virtual void map(const double* differences, int count, double* mapped) = 0;
  // Of one of them, in units of the tolerances.
  virtual double norm(const double* mapped) const = 0;
};

class BdfErrorEstimate {
 public:
  // in_place: errors are mapped so, see SystemTraits.
  void resize(std::size_t n, std::size_t size_w, bool in_place);
  // The error of a step in units of the tolerances, the system standing at its end, and the local terms of the orders
  // around that of the step: that of the next higher one if it may become the order (may_rise), and those of lower ones
  // as far as they can lower the order.
  struct Judged {
    const BdfStep& step;
    bool may_rise;
  };
  double estimate(StrangenessFreeSystem& system, const BdfHistory& history, const Judged& judged,
                  const ErrorWeights& weights, LocalTerms& terms);
  // The same of anything else that is discretized so.
  double estimate(ErrorMap& map, const BdfHistory& history, const Judged& judged, LocalTerms& terms);
  // Of the step estimated last, mapped to x, without its constant.
  const std::vector<double>& error() const { return error_; }

 private:
  std::vector<double> difference_, error_;
  // Of the orders around that of the step, a column each.
  std::vector<double> differences_, mapped_;  // the latter: none, where they are mapped in place
};

}  // namespace sfdae::core
