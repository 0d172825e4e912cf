// Names of the operations.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/operation.h"

#include <cstddef>

namespace sfdae::core {

const char* name_of(Operation operation) {
  constexpr const char* names[] = {
      "constant", "parameter", "t",     "x",    "x'",   "negate", "add",   "subtract", "multiply", "division",
      "power",    "power",     "sqrt",  "exp",  "log",  "log10",  "sin",   "cos",      "tan",      "asin",
      "acos",     "atan",      "atan2", "sinh", "cosh", "tanh",   "floor", "modulo",   "choose",   "function"};
  static_assert(sizeof names / sizeof *names == static_cast<std::size_t>(Operation::function) + 1);
  return names[static_cast<std::size_t>(operation)];
}

}  // namespace sfdae::core
