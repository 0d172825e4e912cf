// Values of recorded equations that do not depend on x or x'.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/tape.h"
#include "expression/taylor_evaluator.h"

namespace sfdae::core {

class ValuesOfTime {
 public:
  // Parameters have the values of the evaluator, which must outlive this object, at the time of a call. It has no
  // source.
  explicit ValuesOfTime(const TaylorEvaluator& evaluator);

  const Tape& tape() const { return evaluator_->tape(); }
  // Changes whenever parameters change.
  long version() const { return evaluator_->changes_of_parameters(); }
  // Slots of all values: those of constants, parameters and functions of t alone are set, others stay unchanged. Not
  // finite if a function fails, within a QuietArithmetic of the caller's. Allocates nothing.
  double* at(double t);
  // Slots of the last time.
  const double* numbers() const { return slots_.data(); }

 private:
  const TaylorEvaluator* evaluator_;
  std::vector<double> slots_;
  long version_ = -1;  // of the parameters
};

}  // namespace sfdae::core
