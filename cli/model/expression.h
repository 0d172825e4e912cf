// Expressions of a flat model: scalar formulas in time, variables and their derivatives. Nodes are shared and never
// change. Truth values are the numbers 1 and 0; enumerations count from 1.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

namespace sfdae::cli {

// Position in the file; both count from 1, 0: unknown.
struct Location {
  int line = 0, column = 0;
};

enum class Operation {
  number,
  time,
  variable,    // the variable `index`
  derivative,  // der of the variable `index`
  previous,    // pre of the variable `index`: its left limit
  // One operand.
  negate,
  abs,
  sign,
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
  sinh,
  cosh,
  tanh,
  floor,    // events where it jumps, unless inside no_event
  ceil,     // as floor
  integer,  // floor of a Real, as an Integer
  not_,
  no_event,  // relations in the operand are taken literally
  // Two operands.
  add,
  subtract,
  multiply,
  divide,
  power,
  atan2,
  min,
  max,
  div,  // truncates toward zero
  mod,  // sign of the second
  rem,  // sign of the first
  less,
  less_equal,
  greater,
  greater_equal,
  equal,
  not_equal,
  and_,
  or_,
  sample,  // start, interval: 1 at start + i interval, else 0
  // Three operands.
  choose,  // the second if the first is 1, else the third
  // None.
  initial,  // 1 while initial values are computed
  terminal  // 1 at the successful end
};

struct Node;
using Expression = std::shared_ptr<const Node>;

struct Node {
  Operation operation = Operation::number;
  double value = 0.0;  // number
  int index = -1;      // variable, derivative, previous
  std::vector<Expression> operands;
  Location at;
};

}  // namespace sfdae::cli
