// Operations on numbers: series of order 0.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/kernel.h"

namespace sfdae::core {

std::optional<double> evaluate(Operation operation, double a, double b, double c) {
  double slots[] = {a, b, c, 0.0, 0.0, 0.0};
  const Instruction instruction{code_of(operation), 3, 0, 1, 2, 4, 5};
  execute<false>(instruction, slots, series::Fixed<0>());
  const bool is_second = operation == Operation::cos || operation == Operation::cosh;
  const double result = slots[is_second ? instruction.p : instruction.v];
  if (!std::isfinite(result)) return std::nullopt;
  return result;
}

}  // namespace sfdae::core
