// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/arithmetic.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "modelica/lexer.h"

namespace sfdae::cli {

using syntax::Operator;

namespace {

bool is_relation(Operation operation) {
  switch (operation) {
    case Operation::less:
    case Operation::less_equal:
    case Operation::greater:
    case Operation::greater_equal:
    case Operation::equal:
    case Operation::not_equal:
    case Operation::floor:
    case Operation::ceil:
    case Operation::integer:
    case Operation::div:
    case Operation::mod:
    case Operation::rem: return true;
    default: return false;
  }
}

const char* shown(Operator op) {
  switch (op) {
    case Operator::add: return "+";
    case Operator::subtract: return "-";
    case Operator::multiply: return "*";
    case Operator::divide: return "/";
    case Operator::power: return "^";
    case Operator::element_add: return ".+";
    case Operator::element_subtract: return ".-";
    case Operator::element_multiply: return ".*";
    case Operator::element_divide: return "./";
    case Operator::element_power: return ".^";
    case Operator::less: return "<";
    case Operator::less_equal: return "<=";
    case Operator::greater: return ">";
    case Operator::greater_equal: return ">=";
    case Operator::equal: return "==";
    case Operator::not_equal: return "<>";
    case Operator::and_: return "and";
    case Operator::or_: return "or";
    case Operator::not_: return "not";
    case Operator::plus: return "+";
    case Operator::negate: return "-";
  }
  return "";
}

Operation operation_of(Operator op) {
  switch (op) {
    case Operator::add:
    case Operator::element_add: return Operation::add;
    case Operator::subtract:
    case Operator::element_subtract: return Operation::subtract;
    case Operator::multiply:
    case Operator::element_multiply: return Operation::multiply;
    case Operator::divide:
    case Operator::element_divide: return Operation::divide;
    case Operator::power:
    case Operator::element_power: return Operation::power;
    case Operator::less: return Operation::less;
    case Operator::less_equal: return Operation::less_equal;
    case Operator::greater: return Operation::greater;
    case Operator::greater_equal: return Operation::greater_equal;
    case Operator::equal: return Operation::equal;
    case Operator::not_equal: return Operation::not_equal;
    case Operator::and_: return Operation::and_;
    case Operator::or_: return Operation::or_;
    case Operator::not_: return Operation::not_;
    default: return Operation::negate;
  }
}

[[noreturn]] void fail_types(const Elaboration& e, Operator op, const Value& left, const Value& right, Location at) {
  e.fail(at, std::string("'") + shown(op) + "' between " + shown_type(left) + " and " + shown_type(right) +
                 "; make the types and sizes agree");
}

// Element by element; a scalar is combined with every element.
Value map_elements(Elaboration& e, Operation operation, const Value& left, const Value& right, OperationPlace place) {
  Value result;
  result.dims = left.is_scalar() ? right.dims : left.dims;
  const size_t n = product(result.dims);
  e.charge(static_cast<long>(n), place.at);
  result.scalars.reserve(n);
  for (size_t k = 0; k < n; ++k)
    result.scalars.push_back(operate(
        e, operation, {left.scalars[left.is_scalar() ? 0 : k], right.scalars[right.is_scalar() ? 0 : k]}, place));
  return result;
}

Value compare(Elaboration& e, Operator op, const Value& left, const Value& right, OperationPlace place) {
  if (!left.is_scalar() || !right.is_scalar()) fail_types(e, op, left, right, place.at);
  if (left.kind == Kind::string && right.kind == Kind::string) {
    if (!left.texts[0].is_exact || !right.texts[0].is_exact)
      e.fail(place.at, "a comparison of strings that are known at run time only; compare numbers");
    const int order = left.texts[0].text.compare(right.texts[0].text);
    const std::optional<double> result = sfdae::cli::apply(operation_of(op), {static_cast<double>(order), 0.0});
    return scalar_value(Kind::boolean, e.pool.number(*result, place.at));
  }
  const bool fit = (left.is_numeric() && right.is_numeric()) ||
                   (left.kind == right.kind && left.has_scalars() && left.definition == right.definition);
  if (!fit) fail_types(e, op, left, right, place.at);
  const Expression result = operate(e, operation_of(op), {left.scalars[0], right.scalars[0]}, place);
  const bool is_equality = op == Operator::equal || op == Operator::not_equal;
  if (is_equality && !place.in_function && (left.kind == Kind::real || right.kind == Kind::real)) {
    e.real_equalities.push_back(result);
    e.real_equality_locations.push_back(place.at);
  }
  return scalar_value(Kind::boolean, result);
}

Value matrix_power(Elaboration& e, const Value& matrix, const Value& exponent, OperationPlace place) {
  const std::optional<double> n = constant_value(e, exponent.scalars[0]);
  if (matrix.dims.size() != 2 || matrix.dims[0] != matrix.dims[1] || !n || *n < 0.0 || *n != std::floor(*n) ||
      *n > 1e3)
    fail_types(e, Operator::power, matrix, exponent, place.at);
  Value result = empty_like(matrix, matrix.dims);
  for (int i = 0; i < matrix.dims[0]; ++i)
    for (int j = 0; j < matrix.dims[0]; ++j) result.scalars.push_back(e.pool.number(i == j ? 1.0 : 0.0, place.at));
  for (int k = 0; k < static_cast<int>(*n); ++k) result = multiply(e, result, matrix, place);
  return result;
}

Value arithmetic(Elaboration& e, Operator op, const Value& left, const Value& right, OperationPlace place) {
  const bool is_element_wise = op >= Operator::element_add && op <= Operator::element_power;
  if (op == Operator::multiply && !left.is_scalar() && !right.is_scalar()) return multiply(e, left, right, place);
  if (op == Operator::power && !left.is_scalar() && right.is_scalar()) return matrix_power(e, left, right, place);
  const bool may_mix = is_element_wise || op == Operator::multiply || (op == Operator::divide && right.is_scalar());
  const bool fit = left.dims == right.dims
                       ? is_element_wise || left.is_scalar() || op == Operator::add || op == Operator::subtract
                       : may_mix && (left.is_scalar() || right.is_scalar());
  if (!fit) fail_types(e, op, left, right, place.at);
  Value result = map_elements(e, operation_of(op), left, right, place);
  const bool is_real = operation_of(op) == Operation::divide || operation_of(op) == Operation::power;
  result.kind = !is_real && left.kind == Kind::integer && right.kind == Kind::integer ? Kind::integer : Kind::real;
  return result;
}

}  // namespace

Expression operate(Elaboration& e, Operation operation, std::vector<Expression> operands, OperationPlace place) {
  for (const Expression& operand : operands)
    if (operand == nullptr) e.fail(place.at, "a value is used before it has been assigned; assign it in every case");
  const bool is_literal = place.in_function && is_relation(operation);
  Expression result = e.pool.make(operation, std::move(operands), place.at);
  return is_literal ? e.pool.make(Operation::no_event, {result}, place.at) : result;
}

Expression sum_of(Elaboration& e, const std::vector<Expression>& terms, Location at) {
  for (const Expression& term : terms)
    if (term == nullptr) e.fail(at, "a value is used before it has been assigned; assign it in every case");
  return e.pool.sum(terms, at);
}

Value binary(Elaboration& e, Operator op, const Value& left, const Value& right, OperationPlace place) {
  if (op >= Operator::less && op <= Operator::not_equal) return compare(e, op, left, right, place);
  if (op == Operator::and_ || op == Operator::or_) {
    const bool fit = left.kind == Kind::boolean && right.kind == Kind::boolean && left.dims == right.dims;
    if (!fit) fail_types(e, op, left, right, place.at);
    Value result = map_elements(e, operation_of(op), left, right, place);
    result.kind = Kind::boolean;
    return result;
  }
  if (op == Operator::add && left.kind == Kind::string && right.kind == Kind::string && left.is_scalar() &&
      right.is_scalar()) {
    e.charge(static_cast<long>(left.texts[0].text.size() + right.texts[0].text.size()), place.at);
    return text_value(left.texts[0].text + right.texts[0].text, left.texts[0].is_exact && right.texts[0].is_exact);
  }
  if (!left.is_numeric() || !right.is_numeric()) fail_types(e, op, left, right, place.at);
  return arithmetic(e, op, left, right, place);
}

Value unary(Elaboration& e, Operator op, const Value& operand, OperationPlace place) {
  const bool fit = op == Operator::not_ ? operand.kind == Kind::boolean : operand.is_numeric();
  if (!fit)
    e.fail(place.at, std::string("'") + shown(op) + "' of " + shown_type(operand) + "; the type does not fit");
  if (op == Operator::plus) return operand;
  Value result = empty_like(operand, operand.dims);
  for (const Expression& x : operand.scalars) result.scalars.push_back(operate(e, operation_of(op), {x}, place));
  return result;
}

// Products of vectors and matrices: v v, A v, v A, A B.
Value multiply(Elaboration& e, const Value& left, const Value& right, OperationPlace place) {
  const size_t p = left.dims.size(), q = right.dims.size();
  if (p < 1 || q < 1 || p > 2 || q > 2 || left.dims.back() != right.dims.front())
    fail_types(e, Operator::multiply, left, right, place.at);
  const size_t rows = p == 2 ? static_cast<size_t>(left.dims[0]) : 1, inner = static_cast<size_t>(right.dims[0]);
  const size_t columns = q == 2 ? static_cast<size_t>(right.dims[1]) : 1;
  Value result;
  result.kind = left.kind == Kind::integer && right.kind == Kind::integer ? Kind::integer : Kind::real;
  if (p == 2) result.dims.push_back(static_cast<int>(rows));
  if (q == 2) result.dims.push_back(static_cast<int>(columns));
  check_dims(e, result.dims, place.at);
  e.charge(static_cast<long>(rows * inner * columns), place.at);
  for (size_t i = 0; i < rows; ++i)
    for (size_t j = 0; j < columns; ++j) {
      std::vector<Expression> terms;
      for (size_t k = 0; k < inner; ++k)
        terms.push_back(
            operate(e, Operation::multiply, {left.scalars[i * inner + k], right.scalars[k * columns + j]}, place));
      result.scalars.push_back(sum_of(e, terms, place.at));
    }
  return result;
}

}  // namespace sfdae::cli
