// Where solutions move along surfaces on which equations are continuous by regularized_conditions.h, and how accurately
// x has to be known there.
//
// Within the width of a surface the part u of a branch changes from 0 to 1 while x changes by no more than its
// tolerances. Errors of x that do not matter as such are errors of forces then, which do: too coarse a step may not see
// that u leaves 0 ... 1 for a while, and x with it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "expression/condition_functions.h"
#include "expression/regularized_conditions.h"
#include "expression/taylor_evaluator.h"

namespace sfdae::core {

class SlidingLayers {
 public:
  // Conditions of these equations, which have the values that parameters have in `parameters`.
  void add(std::shared_ptr<const Record> record, const TaylorEvaluator& parameters,
           const std::vector<RegularizedCondition>& which);
  // Sets limits, as many as unknowns, of errors of x: with these the error of u is `part` at most in all layers that x
  // lies in; infinity where there are none. Nothing is allocated.
  void find_limits(double t, const double* x, double part, std::vector<double>& limits);

 private:
  struct Round {
    std::unique_ptr<TaylorEvaluator> equations;
    std::unique_ptr<ConditionFunctions> functions;
    std::vector<double> widths, g, gradients;
  };
  std::vector<Round> rounds_;
};

}  // namespace sfdae::core
