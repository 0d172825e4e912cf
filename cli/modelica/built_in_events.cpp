// der, pre and other operators on time and events, and conversions.
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/built_in.h"
#include "modelica/lexer.h"
#include "modelica/symbols.h"

namespace sfdae::cli {

namespace {

using Function = Value (*)(Elaboration&, const Environment&, const Call&);

// Applies a change to every scalar, including those in records.
template <class Change>
Value changed(Value value, Change change) {
  for (Expression* x : scalars_of(value)) *x = change(*x);
  return value;
}

void not_in_function(const Elaboration& e, const Environment& in, const Call& call) {
  if (in.in_function) e.fail(call.at, "'" + call.name + "' in a function; functions know their arguments only");
}

Value der(Elaboration& e, const Environment& in, const Call& call) {
  check_count(e, call, 1, 1);
  not_in_function(e, in, call);
  Value argument = call.arguments[0].value;
  for (const Expression* x : scalars_of(argument)) {
    if (*x == nullptr || (*x)->operation != Operation::variable) continue;
    const Variable& variable = e.model.variables[static_cast<size_t>((*x)->index)];
    if (variable.variability == Variability::discrete)
      e.fail(call.at, "der of '" + variable.name + "', which is discrete; only continuous Reals have derivatives");
  }
  if (!argument.is_numeric()) e.fail(call.at, "der of " + shown_type(argument) + "; only Reals have derivatives");
  argument.kind = Kind::real;
  return changed(std::move(argument), [&](const Expression& x) { return derivative(e, x, call.at); });
}

Expression previous(Elaboration& e, const Expression& x, const Call& call) {
  if (x == nullptr) e.fail(call.at, "'" + call.name + "' of a value that has not been assigned");
  if (!e.pool.varies(x)) return x;
  if (x->operation != Operation::variable)
    e.fail(call.at, "'" + call.name + "' of a formula; introduce a variable for it");
  return e.pool.variable(Operation::previous, x->index, true, call.at);
}

Value pre(Elaboration& e, const Environment& in, const Call& call) {
  check_count(e, call, 1, 1);
  not_in_function(e, in, call);
  if (!call.arguments[0].value.has_scalars()) e.fail(call.at, "'pre' of " + shown_type(call.arguments[0].value));
  return changed(call.arguments[0].value, [&](const Expression& x) { return previous(e, x, call); });
}

Value edge(Elaboration& e, const Environment& in, const Call& call) {
  check_count(e, call, 1, 1);
  not_in_function(e, in, call);
  if (call.arguments[0].value.kind != Kind::boolean)
    e.fail(call.at, "'edge' of " + shown_type(call.arguments[0].value) + ", expected Boolean");
  return changed(call.arguments[0].value, [&](const Expression& x) {
    const Expression was = previous(e, x, call);
    return e.pool.make(Operation::and_, {x, e.pool.make(Operation::not_, {was}, call.at)}, call.at);
  });
}

Value change(Elaboration& e, const Environment& in, const Call& call) {
  check_count(e, call, 1, 1);
  not_in_function(e, in, call);
  if (!call.arguments[0].value.has_scalars()) e.fail(call.at, "'change' of " + shown_type(call.arguments[0].value));
  Value result = changed(call.arguments[0].value, [&](const Expression& x) {
    const Expression was = previous(e, x, call);
    return x == was ? e.pool.truth(false, call.at) : e.pool.make(Operation::not_equal, {x, was}, call.at);
  });
  result.kind = Kind::boolean;
  return result;
}

Value initial_or_terminal(Elaboration& e, const Environment& in, const Call& call) {
  check_count(e, call, 0, 0);
  not_in_function(e, in, call);
  const Operation operation = call.name == "initial" ? Operation::initial : Operation::terminal;
  return scalar_value(Kind::boolean, e.pool.leaf(operation, call.at));
}

Value sample(Elaboration& e, const Environment& in, const Call& call) {
  not_in_function(e, in, call);
  if (call.arguments.size() != 2 || !call.arguments[0].value.is_scalar() || !call.arguments[1].value.is_numeric())
    e.fail(call.at, "'sample' of a clock is not supported; use sample(start, interval) in a when clause");
  const Expression start = scalar_argument(e, call, 0, Kind::real),
                   interval = scalar_argument(e, call, 1, Kind::real);
  if (e.pool.varies(start) || e.pool.varies(interval))
    e.fail(call.at, "'sample' with a start or interval that varies; use constants and parameters");
  return scalar_value(Kind::boolean, e.pool.make(Operation::sample, {start, interval}, call.at));
}

Value no_event(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  return changed(call.arguments[0].value, [&](const Expression& x) {
    return x == nullptr ? x : e.pool.make(Operation::no_event, {x}, call.at);
  });
}

// smooth(p, x): with p > 0, the jumps of x are in derivatives that hardly affect a step.
Value smooth(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 2, 2);
  const int order = integer_argument(e, call, 0);
  if (order <= 0) return call.arguments[1].value;
  return changed(call.arguments[1].value, [&](const Expression& x) {
    return x == nullptr ? x : e.pool.make(Operation::no_event, {x}, call.at);
  });
}

Value homotopy(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 2, 4);
  for (const Argument& one : call.arguments)
    if (one.name == "actual") return one.value;
  return call.arguments[0].value;
}

// semiLinear(x, p, n) = if x >= 0 then p x else n x
Value semi_linear(Elaboration& e, const Environment& in, const Call& call) {
  check_count(e, call, 3, 3);
  const OperationPlace place{call.at, in.in_function};
  const Expression x = scalar_argument(e, call, 0, Kind::real);
  const Expression is_positive = operate(e, Operation::greater_equal, {x, e.pool.number(0.0, call.at)}, place);
  const Expression positive = operate(e, Operation::multiply, {scalar_argument(e, call, 1, Kind::real), x}, place);
  const Expression negative = operate(e, Operation::multiply, {scalar_argument(e, call, 2, Kind::real), x}, place);
  return scalar_value(Kind::real, e.pool.make(Operation::choose, {is_positive, positive, negative}, call.at));
}

// The ordinal of an enumeration; whole numbers are returned unchanged.
Value to_integer(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  Value result = call.arguments[0].value;
  if (result.kind != Kind::enumeration && result.kind != Kind::integer)
    e.fail(call.at, "'Integer' of " + shown_type(result) + ", expected an enumeration; use integer(...) for Reals");
  result.kind = Kind::integer;
  result.definition = nullptr;
  return result;
}

Value to_real(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  return convert(e, call.arguments[0].value, Kind::real, nullptr, "the argument of 'Real'", call.at);
}

// Only for messages unless the value is constant.
Value to_string(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 5);
  const Value& value = call.arguments[0].value;
  if (value.kind == Kind::string) return value;
  if (!value.has_scalars() || !value.is_scalar() || value.scalars[0] == nullptr || !is_number(value.scalars[0]))
    return text_value("...", false);
  const double x = value.scalars[0]->value;
  if (value.kind == Kind::boolean) return text_value(x != 0.0 ? "true" : "false");
  if (value.kind == Kind::enumeration && x >= 1.0 && x <= static_cast<double>(value.definition->literals.size()))
    return text_value(plain(value.definition->literals[static_cast<size_t>(x) - 1].name));
  char text[64];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text_value(text, call.arguments.size() == 1);
}

// guess(x) is the start value of x.
Value guess(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  return changed(call.arguments[0].value, [&](const Expression& x) {
    if (x == nullptr || x->operation != Operation::variable)
      e.fail(call.at, "'guess' of something that is no variable");
    const Expression& start = e.model.variables[static_cast<size_t>(x->index)].start;
    return start ? start : e.pool.number(0.0, call.at);
  });
}

Value parameter_equal(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 2, 2);
  const Expression a = scalar_argument(e, call, 0, Kind::real), b = scalar_argument(e, call, 1, Kind::real);
  return scalar_value(Kind::boolean, e.pool.make(Operation::equal, {a, b}, call.at));
}

Value pure(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  return call.arguments[0].value;
}

void reject(const Elaboration& e, const Call& call) {
  constexpr std::array<std::string_view, 17> clocked = {"hold",
                                                        "previous",
                                                        "subSample",
                                                        "superSample",
                                                        "shiftSample",
                                                        "backSample",
                                                        "noClock",
                                                        "interval",
                                                        "Clock",
                                                        "firstTick",
                                                        "inStream",
                                                        "actualStream",
                                                        "cardinality",
                                                        "spatialDistribution",
                                                        "getInstanceName",
                                                        "connect",
                                                        "isPresent"};
  if (call.name == "delay")
    e.fail(call.at, "'delay' is not supported; replace it, for example by a chain of first-order lags");
  for (const std::string_view name : clocked)
    if (call.name == name) e.fail(call.at, "'" + call.name + "' is not supported; replace it in the model");
}

const std::map<std::string, Function>& functions() {
  static const std::map<std::string, Function> result = {{"der", der},
                                                         {"pre", pre},
                                                         {"edge", edge},
                                                         {"change", change},
                                                         {"initial", initial_or_terminal},
                                                         {"terminal", initial_or_terminal},
                                                         {"sample", sample},
                                                         {"noEvent", no_event},
                                                         {"smooth", smooth},
                                                         {"homotopy", homotopy},
                                                         {"semiLinear", semi_linear},
                                                         {"Integer", to_integer},
                                                         {"Real", to_real},
                                                         {"String", to_string},
                                                         {"guess", guess},
                                                         {"realParameterEqual", parameter_equal},
                                                         {"pure", pure}};
  return result;
}

}  // namespace

std::optional<Value> call_event_operator(Elaboration& e, const Environment& in, const Call& call) {
  const auto found = functions().find(call.name);
  if (found != functions().end()) return found->second(e, in, call);
  reject(e, call);
  return std::nullopt;
}

}  // namespace sfdae::cli
