// Conditions on x or x' of recorded equations, g(t, x, x') > 0, and the branches that choices take: as g says, or one
// that is held, whatever g says. With branches held equations are smooth where g passes zero.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "expression/record.h"
#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// The same equations, with conditions that can be held.
std::shared_ptr<const Record> with_conditions(std::shared_ptr<const Record> record);

class HeldConditions {
 public:
  // The evaluator, of equations with such conditions, lives as long as this. changed: called when branches are others.
  HeldConditions(TaylorEvaluator& evaluator, std::function<void()> changed);

  std::size_t count() const { return conditions_.size(); }
  bool depend_on_derivatives() const { return depend_on_derivatives_; }
  // g at a point, a number for each; NaN where it cannot be evaluated.
  void evaluate(double t, const double* x, const double* xdot, double* g);
  // By how much each g may change if x changes by so much (n values); infinite where that cannot be evaluated.
  std::vector<double> resolution(double t, const double* x, const double* xdot, const double* changes);
  // Branches from now on: those that these values of g lead to.
  void hold(const double* g);
  // As g says from now on.
  void release();
  // The equation that contains a condition, as messages call it.
  std::string equation_with(std::size_t condition) const;

 private:
  void load(const double* x, const double* xdot);

  TaylorEvaluator& evaluator_;
  std::function<void()> changed_;
  const std::vector<Condition>& conditions_;
  std::optional<TaylorEvaluator> functions_;
  long version_ = -1;  // of the parameters of functions_
  bool depend_on_derivatives_ = false;
  std::vector<double> jet_;
  std::vector<std::vector<int>> alone_;  // each function's number
};

}  // namespace sfdae::core
