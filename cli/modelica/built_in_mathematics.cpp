// Mathematical functions, element by element.
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/built_in.h"

namespace sfdae::cli {

namespace {

enum class ResultKind { real, integer, as_operands };

struct Function {
  std::string_view name;
  Operation operation;
  size_t count;
  ResultKind result;
};

constexpr std::array<Function, 26> kFunctions = {
    {{"abs", Operation::abs, 1, ResultKind::as_operands}, {"sign", Operation::sign, 1, ResultKind::integer},
     {"sqrt", Operation::sqrt, 1, ResultKind::real},      {"exp", Operation::exp, 1, ResultKind::real},
     {"log", Operation::log, 1, ResultKind::real},        {"log10", Operation::log10, 1, ResultKind::real},
     {"sin", Operation::sin, 1, ResultKind::real},        {"cos", Operation::cos, 1, ResultKind::real},
     {"tan", Operation::tan, 1, ResultKind::real},        {"asin", Operation::asin, 1, ResultKind::real},
     {"acos", Operation::acos, 1, ResultKind::real},      {"atan", Operation::atan, 1, ResultKind::real},
     {"sinh", Operation::sinh, 1, ResultKind::real},      {"cosh", Operation::cosh, 1, ResultKind::real},
     {"tanh", Operation::tanh, 1, ResultKind::real},      {"floor", Operation::floor, 1, ResultKind::real},
     {"ceil", Operation::ceil, 1, ResultKind::real},      {"integer", Operation::integer, 1, ResultKind::integer},
     {"atan2", Operation::atan2, 2, ResultKind::real},    {"min", Operation::min, 2, ResultKind::as_operands},
     {"max", Operation::max, 2, ResultKind::as_operands}, {"div", Operation::div, 2, ResultKind::as_operands},
     {"mod", Operation::mod, 2, ResultKind::as_operands}, {"rem", Operation::rem, 2, ResultKind::as_operands},
     {"$pow", Operation::power, 2, ResultKind::real},     {"$fmod", Operation::rem, 2, ResultKind::real}}};

Kind result_kind(const Function& function, const std::vector<Argument>& arguments) {
  if (function.result == ResultKind::real) return Kind::real;
  if (function.result == ResultKind::integer) return Kind::integer;
  for (const Argument& one : arguments)
    if (one.value.kind == Kind::real) return Kind::real;
  return arguments[0].value.kind;
}

Value apply_function(Elaboration& e, const Environment& in, const Function& function, const Call& call) {
  check_count(e, call, function.count, function.count);
  const bool takes_others = function.operation == Operation::min || function.operation == Operation::max;
  const Value* shape = &call.arguments[0].value;
  for (const Argument& one : call.arguments) {
    if (!one.value.is_numeric() && !(takes_others && one.value.has_scalars()))
      e.fail(one.at, "an argument of '" + call.name + "' is " + shown_type(one.value) + ", expected a number");
    if (!one.value.is_scalar()) shape = &one.value;
  }
  Value result = empty_like(*shape, shape->dims);
  result.kind = result_kind(function, call.arguments);
  e.charge(static_cast<long>(shape->scalars.size()), call.at);
  for (size_t k = 0; k < shape->scalars.size(); ++k) {
    std::vector<Expression> operands;
    for (const Argument& one : call.arguments) {
      if (!one.value.is_scalar() && one.value.dims != shape->dims)
        e.fail(call.at, "arguments of '" + call.name + "' differ in size");
      operands.push_back(one.value.scalars[one.value.is_scalar() ? 0 : k]);
    }
    // floor, ceil and integer of an Integer are the Integer itself, without events.
    const bool is_whole = function.count == 1 && call.arguments[0].value.kind == Kind::integer &&
                          (function.operation == Operation::floor || function.operation == Operation::ceil ||
                           function.operation == Operation::integer);
    result.scalars.push_back(
        is_whole ? operands[0] : operate(e, function.operation, std::move(operands), {call.at, in.in_function}));
  }
  return result;
}

// min and max of one array.
Value reduce(Elaboration& e, const Call& call, Operation operation) {
  const Value& array = call.arguments[0].value;
  if (array.is_scalar() || array.scalars.empty())
    e.fail(call.at, "'" + call.name + "' of " + shown_type(array) + "; give two numbers or an array");
  std::vector<Expression> level = array.scalars;
  while (level.size() > 1) {
    std::vector<Expression> next;
    for (size_t k = 0; k + 1 < level.size(); k += 2)
      next.push_back(operate(e, operation, {level[k], level[k + 1]}, {call.at}));
    if (level.size() % 2 == 1) next.push_back(level.back());
    level = std::move(next);
  }
  Value result = empty_like(array, {});
  result.scalars = std::move(level);
  return result;
}

}  // namespace

std::optional<Value> call_mathematics(Elaboration& e, const Environment& in, const Call& call) {
  for (const Function& function : kFunctions) {
    if (function.name != call.name) continue;
    const bool reduces = function.operation == Operation::min || function.operation == Operation::max;
    if (reduces && call.arguments.size() == 1) return reduce(e, call, function.operation);
    return apply_function(e, in, function, call);
  }
  return std::nullopt;
}

std::optional<std::string> built_in_of_external(const std::string& name) {
  if (name == "fabs") return "abs";
  if (name == "fmod") return "$fmod";
  if (name == "pow") return "$pow";
  for (const Function& function : kFunctions) {
    const bool differs_in_c = function.name == "abs" || function.name == "div" || function.name == "min" ||
                              function.name == "max" || function.name == "mod" || function.name == "rem" ||
                              function.name == "integer" || function.name == "sign";
    if (function.name == name && !differs_in_c) return name;
  }
  return std::nullopt;
}

void check_count(const Elaboration& e, const Call& call, size_t min, size_t max) {
  if (call.arguments.size() >= min && call.arguments.size() <= max) return;
  const std::string wanted = min == max ? std::to_string(min) : std::to_string(min) + " to " + std::to_string(max);
  e.fail(call.at, "'" + call.name + "' takes " + wanted + " arguments, not " + std::to_string(call.arguments.size()));
}

Expression scalar_argument(const Elaboration& e, const Call& call, size_t k, Kind kind) {
  const Argument& one = call.arguments[k];
  const bool fits = one.value.kind == kind || (kind == Kind::real && one.value.kind == Kind::integer);
  if (!fits || !one.value.is_scalar())
    e.fail(one.at,
           "an argument of '" + call.name + "' is " + shown_type(one.value) + ", expected " + shown_kind(kind));
  if (one.value.scalars[0] == nullptr) e.fail(one.at, "an argument of '" + call.name + "' has not been assigned");
  return one.value.scalars[0];
}

int integer_argument(Elaboration& e, const Call& call, size_t k) {
  const Expression x = scalar_argument(e, call, k, Kind::integer);
  const std::optional<double> value = constant_value(e, x);
  if (!value) e.fail(call.arguments[k].at, "an argument of '" + call.name + "' varies; use constants and parameters");
  if (!(*value >= -2e9 && *value <= 2e9))
    e.fail(call.arguments[k].at, "an argument of '" + call.name + "' is too large");
  return static_cast<int>(*value);
}

}  // namespace sfdae::cli
