// Properties of the operations of expressions, and their values for numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/expression.h"

namespace sfdae::cli {

int num_operands(Operation operation);
bool is_relation(Operation operation);
bool is_rounding(Operation operation);  // floor, ceil, integer, div, mod, rem

// The value of an operation on numbers; unused operands are ignored.
double applied(Operation operation, double a, double b, double c);

}  // namespace sfdae::cli
