// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/import.h"

#include <algorithm>
#include <cmath>

#include "simulation/text.h"

namespace sfdae::cli {

Formula Import::operator()(const Expression& expression, Context context) {
  auto& known = known_[static_cast<std::size_t>(context)];
  const auto place = known.find(expression.get());
  if (place != known.end()) return place->second;
  const Formula result = imported(*expression, context);
  known[expression.get()] = result;
  return result;
}

namespace {

// Operands of a quantity that changes only at events also change only at events, or their zeros are events.
Context of_operands(Operation operation, Context context) {
  const bool is_stepwise = is_rounding(operation) || is_relation(operation) || operation == Operation::equal ||
                           operation == Operation::not_equal;
  return context == Context::events && is_stepwise ? Context::stepwise : context;
}

}  // namespace

Formula Import::imported(const Node& node, Context given) {
  Formulas& formulas = system_.formulas;
  const Context context = of_operands(node.operation, given);
  const auto operand = [&](std::size_t k) { return (*this)(node.operands.at(k), context); };
  switch (node.operation) {
    case Operation::number: return formulas.number(node.value);
    case Operation::time: return formulas.time();
    case Operation::variable: return variable(node);
    case Operation::derivative: return derivative(node);
    case Operation::previous:
      if (parameters_.is_known(node.index) || parameters_.is_derived(node.index)) return variable(node);
      return formulas.previous(node.index);
    case Operation::initial:
    case Operation::terminal: return formulas.flag(node.operation);
    case Operation::sample: return sample(node, operand(0), operand(1));
    case Operation::no_event:
      return (*this)(node.operands.at(0), context == Context::instant ? context : Context::literal);
    case Operation::choose: {  // a branch that is never taken may be invalid
      const Formula condition = operand(0);
      if (formulas.is_number(condition)) return operand(formulas[condition].value != 0.0 ? 1 : 2);
      const Formula yes = operand(1), no = operand(2);
      return formulas.apply(Operation::choose, condition, yes, no);
    }
    default: break;
  }
  const Formula a = operand(0), b = num_operands(node.operation) == 2 ? operand(1) : -1;
  if (node.operation == Operation::sign) return sign(node, a, context);
  if (is_rounding(node.operation)) return rounding(node, a, b, context);
  return is_relation(node.operation) ? relation(node, a, b, context) : formulas.apply(node.operation, a, b);
}

Formula Import::variable(const Node& node) {
  const Variable& it = system_.model.variables[at(node.index)];
  if (parameters_.is_known(node.index)) return system_.formulas.number(parameters_.value(node.index));
  if (parameters_.is_derived(node.index)) return (*this)(it.binding, Context::literal);
  if (it.is_input)
    throw ModelError(system_.model.file, it.at,
                     "input " + it.name + " has no signal; set it to a constant value, or connect it in the model");
  return system_.formulas.variable(node.index);
}

Formula Import::derivative(const Node& node) {
  const Variable& it = system_.model.variables[at(node.index)];
  if (it.variability == Variability::constant || it.variability == Variability::parameter ||
      parameters_.is_known(node.index))
    return system_.formulas.number(0.0);
  if (it.type != Type::real || it.variability == Variability::discrete)
    throw ModelError(system_.model.file, node.at, "der of " + it.name + ", which changes at events only");
  if (it.is_input) return variable(node);  // reports the error
  return system_.formulas.derivative(node.index);
}

Formula Import::relation(const Node& node, Formula a, Formula b, Context context) {
  Formulas& formulas = system_.formulas;
  const bool makes_events = context == Context::events || context == Context::stepwise;
  if (!makes_events || !(formulas.depends(a, on_continuous) || formulas.depends(b, on_continuous)))
    return formulas.apply(node.operation, a, b);
  const Formula g = formulas.subtract(a, b);
  if (formulas.is_number(g)) return formulas.number(applied(node.operation, formulas[g].value, 0.0, 0.0));
  Switch it;
  it.operation = node.operation;
  it.g = g;
  return frozen(node, it, node.operation);
}

// sign generates no events by itself (Modelica Language Specification 3.6, section 3.7.1).
Formula Import::sign(const Node& node, Formula a, Context context) {
  Formulas& formulas = system_.formulas;
  if (context != Context::stepwise || !formulas.depends(a, on_continuous)) return formulas.apply(node.operation, a);
  const Formula zero = formulas.number(0.0);
  const auto zero_node = std::make_shared<const Node>(Node{Operation::number, 0.0, -1, {}, node.at});
  const auto side = [&](Operation operation) {
    return relation({operation, 0.0, -1, {node.operands.at(0), zero_node}, node.at}, a, zero, context);
  };
  const Formula below = formulas.apply(Operation::choose, side(Operation::less), formulas.number(-1.0), zero);
  return formulas.apply(Operation::choose, side(Operation::greater), formulas.number(1.0), below);
}

Formula Import::frozen(const Node& node, Switch it, Operation operation) {
  const auto key = std::make_tuple(it.kind, it.operation, it.g, -1);
  const auto [place, is_new] = known_switches_.try_emplace(key, static_cast<int>(system_.switches.size()));
  if (is_new) {
    it.at = node.at;
    it.text = to_text(std::make_shared<const Node>(node), system_.model);
    it.nominal = size_of(node);
    system_.switches.push_back(it);
  }
  return system_.formulas.frozen(operation, place->second);
}

double Import::size_of(const Node& node) const {
  double size = 0.0;
  for (const Expression& operand : node.operands) {
    if (operand->operation == Operation::variable) size = std::max(size, system_.sizes.nominal[at(operand->index)]);
    if (operand->operation == Operation::number) size = std::max(size, std::fabs(operand->value));
  }
  return size > 0.0 ? size : 1.0;
}

// Free parameters vary during initialization.
Formula Import::jump(const Node& node, Switch::Kind kind, Formula argument, Context context) {
  Formulas& formulas = system_.formulas;
  if (context == Context::instant || !formulas.depends(argument, on_continuous | on_free))
    return kind == Switch::Kind::floor ? formulas.apply(Operation::floor, argument)
                                       : formulas.apply(Operation::div, argument, formulas.number(1.0));
  Switch it;
  it.kind = kind;
  it.g = argument;
  return frozen(node, it, kind == Switch::Kind::floor ? Operation::floor : Operation::div);
}

Formula Import::rounding(const Node& node, Formula a, Formula b, Context context) {
  Formulas& formulas = system_.formulas;
  const auto varies = [&](Formula f) { return f >= 0 && formulas.depends(f, on_continuous | on_free); };
  if (!varies(a) && !varies(b)) return formulas.apply(node.operation, a, b);
  switch (node.operation) {
    case Operation::ceil: return formulas.negate(jump(node, Switch::Kind::floor, formulas.negate(a), context));
    case Operation::div: return jump(node, Switch::Kind::truncate, formulas.apply(Operation::divide, a, b), context);
    case Operation::mod:
    case Operation::rem: {
      const Switch::Kind kind = node.operation == Operation::mod ? Switch::Kind::floor : Switch::Kind::truncate;
      const Formula count = jump(node, kind, formulas.apply(Operation::divide, a, b), context);
      return formulas.subtract(a, formulas.multiply(count, b));
    }
    default: return jump(node, Switch::Kind::floor, a, context);
  }
}

Formula Import::sample(const Node& node, Formula start, Formula interval) {
  const Formulas& formulas = system_.formulas;
  if (!formulas.is_number(start) || !formulas.is_number(interval) || formulas[interval].value <= 0.0)
    throw ModelError(system_.model.file, node.at, "sample needs a start and an interval > 0 that are parameters");
  const std::string text = to_text(std::make_shared<const Node>(node), system_.model);
  system_.samples.push_back({formulas[start].value, formulas[interval].value, text, node.at});
  return system_.formulas.flag(Operation::sample, static_cast<int>(system_.samples.size()) - 1);
}

}  // namespace sfdae::cli
