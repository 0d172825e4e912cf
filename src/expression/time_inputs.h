// Inputs of recorded equations: subexpressions of t alone that are combined with x or x'.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "expression/time_enclosures.h"
#include "expression/values_of_time.h"

namespace sfdae::core {

class TimeInputs {
 public:
  // Parameters have the values that the evaluators, which must outlive this object, have at the time of a call.
  explicit TimeInputs(const std::vector<const TaylorEvaluator*>& evaluators);

  // The number of inputs; t itself is none.
  int count() const { return with_slopes_ ? 2 * count_ : count_; }
  // Counts derivatives of inputs as inputs, too, after the inputs, for equations that are differentiated.
  void count_slopes(bool with_slopes) { with_slopes_ = with_slopes; }
  // Returns whether x and x' occur in more than sums, products, sines. Such terms may be negligible until an input is
  // at its largest, as the current of a diode.
  bool are_with_steep_functions() const { return are_with_steep_functions_; }
  // Their values at t; not finite if a function fails, within a QuietArithmetic of the caller's. Allocates nothing.
  void evaluate(double t, double* values);
  // Enclosures of each over an interval of t, after `evaluate` and within a QuietArithmetic of the caller's; unbounded
  // if user-supplied functions contribute.
  void enclose(Interval t, TimeSeries* all);
  // Returns whether an input, or all inputs, are free of user-supplied functions.
  bool is_enclosed(std::size_t input) const { return is_enclosed_[input % is_enclosed_.size()] != 0; }
  bool are_enclosed() const;

 private:
  struct Part {
    ValuesOfTime values;
    TimeEnclosures enclosures;
    std::vector<int> inputs;  // slots
  };
  void enclose_inputs(Interval t, TimeSeries* all);

  std::vector<Part> parts_;
  std::vector<char> is_enclosed_;
  int count_ = 0;
  bool are_with_steep_functions_ = false, with_slopes_ = false;
  std::vector<TimeSeries> enclosed_;
};

}  // namespace sfdae::core
