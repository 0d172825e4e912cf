// Choice of step size and number of stages for the Radau methods.
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996, section IV.8.
// [HW99] E. Hairer, G. Wanner: Stiff differential equations solved by Radau methods. J. Comput. Appl. Math. 111
// (1999).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "integrate/stepper.h"
#include "linalg/archive.h"
#include "system/stage_method.h"

namespace sfdae::core {

// Scaled norms for a step of size h; an error above 1 is too large.
struct ErrorTerms {
  double error = 0.0;  // the one that decides
  int exponent = 1;    // it behaves like h^exponent
  // |h^k w[k]|, w[k] the divided difference of order k: the decay of the coefficients. Negative if unknown.
  std::array<double, 2 * max_stages + 1> decay{};
  ErrorTerms() { decay.fill(-1.0); }
};

// For two quantities with the same steps: the error that requires the shorter steps, and the larger decay terms if
// known for both.
ErrorTerms larger_of(const ErrorTerms& one, const ErrorTerms& other);

// Relative cost of a step by its number of stages.
struct StageCosts {
  std::array<double, max_stages + 1> work{};
};

class RadauControl {
 public:
  void start(const StepOptions& options);
  void set_options(const StepOptions& options);

  int stages() const { return stages_; }
  void set_stages(int stages) { stages_ = stages; }
  int failures_in_a_row() const { return failures_; }
  // Two consecutive failures of the error test: the solution is less smooth than before.
  bool is_rough() const { return failures_ >= 2; }
  bool may_change_stages() const { return options_.max_stages > options_.min_stages; }

  // The next step size after a step of size h. keep: a step of the same size would save factorizations.
  double accepted(double h, const ErrorTerms& terms, const StageCosts& costs, bool keep);
  // Step size after a step without differential equations, which has no error.
  double accepted_without_error(double h);
  double rejected(double h, const ErrorTerms& terms);
  // Step size after a failed evaluation of a stage, or singular equations.
  double failed(double h);
  void archive(Archive& archive);

 private:
  // The option, reduced after recently rejected steps.
  double safety() const;
  double limited(double ratio) const;
  double step_for_stages(int s, const ErrorTerms& terms) const;
  double choose_stages(const ErrorTerms& terms, const StageCosts& costs, double ratio);

  StepOptions options_;
  int stages_ = 3;
  int failures_ = 0;
  int steps_with_stages_ = 0;  // accepted
  int caution_ = 0;            // in parts of the safety factor
  bool any_accepted_ = false;
  double last_h_ = 0.0, last_error_ = 0.0;  // of the last accepted step; 0: no comparison possible
};

}  // namespace sfdae::core
