// Switches of recorded equations that an integration has passed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "expression/condition_functions.h"
#include "expression/record.h"
#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// A switch of equations to another branch.
struct PassedSwitch {
  double t;
  std::shared_ptr<const Record> record;
  int node;  // of this record: a condition, which is met where it is above 0, or a floor, remainder, table
  bool is_condition;
  double before, after;  // branches: 0 or 1 (met), integers, numbers of knots of a table up to there
  bool jumps = false;    // x does there, by impulses
  int condition = 0;     // a number of this condition
};
// Returns the condition as text of C: "t - 1.0 > 0". Tables and user-supplied functions have no text.
std::string text_of(const PassedSwitch& passed);

// Returns the number of the branch that a value leads to; NaN: none.
double branch_at(const SwitchingNode& at, double value);

// Conditions, floors, remainders and tables of t alone, in recorded equations.
class TimedSwitches {
 public:
  // Parameters have the values that the evaluators, which must outlive this object, have at the time of a call.
  explicit TimedSwitches(const std::vector<const TaylorEvaluator*>& evaluators);

  // Returns those with other branches at the second time than at the first.
  std::vector<PassedSwitch> passed(double from, double to);

 private:
  struct Part {
    std::shared_ptr<const Record> record;
    std::vector<SwitchingNode> switches;  // choose: conditions; else the nodes themselves
    ConditionFunctions arguments;         // two for each switch: those of a remainder; else one twice
  };
  std::vector<Part> parts_;
};

}  // namespace sfdae::core
