// What operations of expressions are, and their values on numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/expression.h"

namespace sfdae::cli {

int num_operands(Operation operation);
bool is_relation(Operation operation);
bool is_rounding(Operation operation);  // floor, ceil, integer, div, mod, rem

// The value of an operation on numbers; what it does not need is ignored.
double applied(Operation operation, double a, double b, double c);

}  // namespace sfdae::cli
