// Values of recorded equations that do not depend on x or x'.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/values_of_time.h"

#include "expression/execution.h"
#include "linalg/index.h"

namespace sfdae::core {

ValuesOfTime::ValuesOfTime(const TaylorEvaluator& evaluator)
    : evaluator_(&evaluator), slots_(index(evaluator.tape().num_slots), 0.0) {
  for (const Tape::Number& constant : tape().constants)
    slots_[index(constant.slot)] = evaluator.record().constant(constant.index);
}

double* ValuesOfTime::at(double t) {
  double* const slots = slots_.data();
  if (version_ != evaluator_->changes_of_parameters()) {
    for (const Tape::Number& parameter : tape().parameters)
      slots[parameter.slot] = evaluator_->parameter(parameter.index);
    execute_values(tape().of_parameters, slots);
    version_ = evaluator_->changes_of_parameters();
  }
  if (tape().time >= 0) {
    slots[tape().time] = t;
    execute_values(tape().of_time, slots);
  }
  return slots;
}

}  // namespace sfdae::core
