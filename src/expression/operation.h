// The operations that equations are recorded in.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace sfdae::core {

enum class Operation : std::uint8_t {
  // Leaves; a is an index.
  constant,
  parameter,
  time,
  unknown,     // x_a
  derivative,  // x'_a
  // Operands a, b, c.
  negate,
  add,
  subtract,
  multiply,
  divide,
  power,        // a^b; b depends on parameters only
  log_of_base,  // log a within a^b = exp(b log a)
  sqrt,
  exp,
  log,
  log10,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  atan2,  // angle of the point (b, a)
  sinh,
  cosh,
  tanh,
  floor,
  modulo,  // a - b floor(a / b)
  choose,  // b if a > 0, else c
  // As many operands as its call says; a is the index of the call.
  function
};

// Name of an operation in messages.
const char* name_of(Operation operation);

constexpr bool is_leaf(Operation operation) { return operation <= Operation::derivative; }

// Returns whether a derivative by operand number k exists: there is none by the condition of a choice, nor through
// floor.
constexpr bool is_differentiated(Operation operation, int k) {
  return operation != Operation::floor && (operation != Operation::choose || k > 0);
}

// For functions the result is 1, see operands_of.
constexpr int num_operands(Operation operation) {
  switch (operation) {
    case Operation::add:
    case Operation::subtract:
    case Operation::multiply:
    case Operation::divide:
    case Operation::power:
    case Operation::atan2:
    case Operation::modulo: return 2;
    case Operation::choose: return 3;
    default: return is_leaf(operation) ? 0 : 1;
  }
}

}  // namespace sfdae::core
