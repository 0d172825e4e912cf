// Recorded equations that are linear in x and x', as the functions E, A, f of a linear problem.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "problem/linear_problem.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

// E = F_x', A = -F_x, f = -F at x = x' = 0, and their derivatives in t. Not movable, as functions() point to it.
class RecordedLinearCoefficients {
 public:
  RecordedLinearCoefficients(std::shared_ptr<const Record> record, PrescribedInputs inputs);
  RecordedLinearCoefficients(const RecordedLinearCoefficients&) = delete;
  // Another object that shares the recording.
  std::unique_ptr<RecordedLinearCoefficients> clone() const;
  RecordedLinearCoefficients& operator=(const RecordedLinearCoefficients&) = delete;

  LinearFunctions functions();
  TaylorEvaluator& evaluator() { return evaluator_; }
  // Reason why the last evaluation failed.
  const std::string& failure() const { return evaluator_.failure().message; }
  // Call after parameters have been changed.
  void forget() { known_order_ = -1; }

 private:
  RecordedLinearCoefficients(const TaylorEvaluator& evaluator, PrescribedInputs inputs);
  // Derivative of the given order into `values`: which = 'E', 'A' or 'f'.
  int derivative(char which, double t, int order, double* values);
  bool evaluate(double t, int order);

  TaylorEvaluator evaluator_;
  PrescribedInputs inputs_;
  // Taylor coefficients at known_t_ up to known_order_.
  double known_t_ = 0.0;
  int known_order_ = -1;
  int usual_order_ = 0;  // highest one that has been asked for
  std::vector<double> jet_, F_, F_xdot_, F_x_;
};

}  // namespace sfdae::core
