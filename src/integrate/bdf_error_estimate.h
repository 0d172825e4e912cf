// Error estimate of BDF: differences between w and its predictors of several degrees.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/bdf_step.h"

namespace sfdae::core {

// Map from differences of w to errors of x, or of other variables discretized with it.
class ErrorMap {
 public:
  virtual ~ErrorMap() = default;
  // Maps `count` columns.
  virtual void map(const double* differences, int count, double* mapped) = 0;
  // Norm of one column, in units of the tolerances.
  virtual double norm(const double* mapped) const = 0;
};

class BdfErrorEstimate {
 public:
  // in_place: the system maps errors in place, see SystemTraits.
  void resize(std::size_t n, std::size_t size_w, bool in_place);
  // Error of a step in units of the tolerances, with the system at its end, and local terms of neighboring orders: of
  // the next higher one if may_rise, and of those lower ones that can lower the order.
  struct Judged {
    const BdfStep& step;
    bool may_rise;
  };
  double estimate(StrangenessFreeSystem& system, const BdfHistory& history, const Judged& judged,
                  const ErrorWeights& weights, LocalTerms& terms);
  // Estimate for other variables with the same discretization.
  double estimate(ErrorMap& map, const BdfHistory& history, const Judged& judged, LocalTerms& terms);
  // Error of the last step estimated, mapped to x, without the error constant.
  const std::vector<double>& error() const { return error_; }

 private:
  std::vector<double> difference_, error_;
  // One column for each order around that of the step.
  std::vector<double> differences_, mapped_;  // mapped_: empty if mapped in place
};

}  // namespace sfdae::core
