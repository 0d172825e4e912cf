// Layers about the surfaces that solutions move along, in which equations are continuous (regularized_conditions.h),
// limit the errors that x may have there.
//
// Within the width of a surface the part u of a branch changes from 0 to 1 while x changes by no more than its
// tolerances. Errors of x that are harmless as such then cause errors of forces, which are not. A step that is too
// large may miss that u leaves 0 ... 1 for a while, and x with it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "expression/condition_functions.h"
#include "expression/regularized_conditions.h"
#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// Conditions that became continuous one after the other. Numbers of each round are those of the record that resulted
// from the rounds before.
using RegularizationRounds = std::vector<std::vector<RegularizedCondition>>;

struct LayerPoint {
  double t;
  const double *x, *tolerances;
  bool with_sensitivities;
};

class SlidingLayers {
 public:
  // Adds conditions of these equations, with the values of parameters in `parameters`.
  void add(std::shared_ptr<const Record> record, const TaylorEvaluator& parameters,
           const std::vector<RegularizedCondition>& which);
  // Sets limits of errors of x, one for each unknown: with these the error of u is at most `part` in all layers that x
  // lies in; infinity if there are none. Allocates nothing.
  void find_limits(const LayerPoint& at, double part, std::vector<double>& limits);
  // Returns whether the layers can be evaluated and fit at the point of the last limits: widths depend on slopes of g,
  // and on the side of a surface on which each condition is met. With sensitivities, surfaces that x has left do not
  // fit, either: where x only passes them, sensitivities jump.
  bool fit() const { return fit_; }
  // Returns whether x was within one of them there.
  bool are_entered() const { return entered_; }
  // Returns whether the layers that x was within cease to fit at a point, by far more than allowed: steps end before
  // it.
  bool turn(const LayerPoint& at);
  // Returns the rounds with layers that fit, near the point.
  RegularizationRounds fitting(const RegularizationRounds& rounds, const LayerPoint& at);

 private:
  struct Round {
    std::unique_ptr<TaylorEvaluator> equations;
    std::unique_ptr<ConditionFunctions> functions;
    std::vector<RegularizedCondition> conditions;
    std::vector<double> g, gradients;
    std::vector<char> are_entered;  // by conditions: layers of their surfaces, where limits were asked for last
    double slope(std::size_t k, std::size_t i) const { return gradients[i * conditions.size() + k]; }
    std::size_t leader_of(std::size_t k) const {
      std::size_t leader = 0;
      while (conditions[leader].condition != conditions[k].leader) ++leader;
      return leader;
    }
    bool is_any_entered() const { return std::find(are_entered.begin(), are_entered.end(), 1) != are_entered.end(); }
    bool is_within(std::size_t leader) const { return std::fabs(g[leader]) < conditions[leader].width; }
  };
  bool is_on_side(const Round& round, std::size_t k, std::size_t leader) const;
  bool is_left(const Round& round, std::size_t k, bool with_sensitivities) const;
  bool stays(const Round& round, std::size_t k, const LayerPoint& at) const;
  bool fits(const Round& round, std::size_t k, const LayerPoint& at, double similar) const;

  std::vector<Round> rounds_;
  bool fit_ = true, entered_ = false;
};

}  // namespace sfdae::core
