// Values of recorded equations that do not depend on x or x'.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/tape.h"
#include "expression/taylor_evaluator.h"

namespace sfdae::core {

class ValuesOfTime {
 public:
  // Parameters are those that the evaluator, which lives as long as this, has when it is asked. It has no source.
  explicit ValuesOfTime(const TaylorEvaluator& evaluator);

  const Tape& tape() const { return evaluator_->tape(); }
  // Another one after a change of parameters.
  long version() const { return evaluator_->changes_of_parameters(); }
  // Slots of all values: of constants, parameters and what depends on t alone there; others stay as they are. Not
  // finite where a function fails, within a QuietArithmetic of the caller's. Nothing is allocated.
  double* at(double t);
  // Of the last time.
  const double* numbers() const { return slots_.data(); }

 private:
  const TaylorEvaluator* evaluator_;
  std::vector<double> slots_;
  long version_ = -1;  // of the parameters
};

}  // namespace sfdae::core
