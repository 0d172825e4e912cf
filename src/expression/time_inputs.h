// Inputs of recorded equations: what depends on t alone, where what depends on x or x' is made of it.
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
  // Parameters are those that the evaluators have when they are asked; they live as long as this.
  explicit TimeInputs(const std::vector<const TaylorEvaluator*>& evaluators);

  // t itself is none.
  int count() const { return with_slopes_ ? 2 * count_ : count_; }
  // Derivatives of inputs are inputs, too, after these: of equations that are differentiated.
  void count_slopes(bool with_slopes) { with_slopes_ = with_slopes; }
  // What is made of x and x' besides is more than sums, products, sines: it may be next to nothing until an input is
  // at its largest, as the current of a diode.
  bool are_with_steep_functions() const { return are_with_steep_functions_; }
  // Their values at t; not finite where a function fails, within a QuietArithmetic of the caller's. Nothing is
  // allocated.
  void evaluate(double t, double* values);
  // Enclosures of each over an interval of t, after `evaluate` and within a QuietArithmetic of the caller's; anything
  // where user-supplied functions contribute.
  void enclose(Interval t, TimeSeries* all);
  // Whether no user-supplied function contributes to an input, to any of them.
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
