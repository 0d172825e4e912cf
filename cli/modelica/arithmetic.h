// Operators and functions on values: element by element, matrix products, conversions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "modelica/elaboration.h"

namespace sfdae::cli {

// Position of an operation, and whether it is in a function, where relations do not generate events.
struct OperationPlace {
  Location at;
  bool in_function = false;
};

// One scalar operation; fails if an operand has not been assigned.
Expression operate(Elaboration& e, Operation operation, std::vector<Expression> operands, OperationPlace place);

Value binary(Elaboration& e, syntax::Operator op, const Value& left, const Value& right, OperationPlace place);
Value unary(Elaboration& e, syntax::Operator op, const Value& operand, OperationPlace place);
Value multiply(Elaboration& e, const Value& left, const Value& right, OperationPlace place);
Expression sum_of(Elaboration& e, const std::vector<Expression>& terms, Location at);

// condition ? first : second, element by element; parts missing in one are taken from the other.
Value choose(Elaboration& e, const Expression& condition, const Value& first, const Value& second, Location at);

// Converts to that kind: Integers become Reals, records are matched by names of fields. what: for messages.
Value convert(Elaboration& e, const Value& value, Kind kind, const syntax::Definition* definition,
              const std::string& what, Location at);

// An array of values that have the same type and dimensions.
Value array_of(Elaboration& e, const std::vector<Value>& elements, Location at);

// d/dt
Expression derivative(Elaboration& e, const Expression& expression, Location at);

}  // namespace sfdae::cli
