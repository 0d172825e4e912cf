// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/parameters.h"

#include <cmath>
#include <limits>

#include "simulation/formulas.h"

namespace sfdae::cli {

Parameters::Parameters(const FlatModel& model, const std::map<std::string, double>& given,
                       std::vector<std::string>& warnings)
    : model_(model),
      warnings_(warnings),
      states_(model.variables.size(), State::other),
      values_(model.variables.size(), std::numeric_limits<double>::quiet_NaN()) {
  classify(given);
  for (int i = 0; i < static_cast<int>(states_.size()); ++i)
    if (states_[index(i)] == State::unvisited) find(i);
  for (int i = 0; i < static_cast<int>(states_.size()); ++i)
    if (states_[index(i)] == State::free) guess(i);
  for (int i = 0; i < static_cast<int>(states_.size()); ++i)
    if (states_[index(i)] == State::derived) values_[index(i)] = value(model_.variables[index(i)].binding);
}

void Parameters::classify(const std::map<std::string, double>& given) {
  std::map<std::string, int> places;
  for (int i = 0; i < static_cast<int>(states_.size()); ++i) {
    const Variable& variable = model_.variables[index(i)];
    places[variable.name] = i;
    if (variable.variability == Variability::constant) states_[index(i)] = State::unvisited;
    if (variable.variability == Variability::parameter)
      states_[index(i)] = variable.is_fixed ? State::unvisited : State::free;
  }
  for (const auto& [name, value] : given) {
    const auto place = places.find(name);
    if (place == places.end())
      throw ModelError(model_.file, {}, "there is no parameter or variable " + name + " to set");
    set_given(name, place->second, value);
  }
}

void Parameters::set_given(const std::string& name, int variable, double value) {
  const Variable& it = model_.variables[index(variable)];
  if (!std::isfinite(value)) throw ModelError(model_.file, it.at, "the value given for " + name + " is not finite");
  if (it.variability == Variability::constant) fail(it, "is a constant and cannot be set");
  if (it.is_structural) fail(it, "cannot be set: the equations were chosen by its value; change it in the file");
  if (it.type != Type::real && value != std::floor(value)) fail(it, "needs a whole number");
  if (it.type == Type::enumeration && !(value >= 1.0 && value <= static_cast<double>(it.literals.size())))
    fail(it, "is an enumeration: it needs the number of a literal, 1 to " + std::to_string(it.literals.size()));
  if (it.type == Type::boolean && value != 0.0 && value != 1.0) fail(it, "is a Boolean: it needs 0 or 1");
  if (it.variability == Variability::parameter || it.is_input) {
    states_[index(variable)] = State::known;
    values_[index(variable)] = value;
  } else {
    given_starts_[variable] = value;
  }
}

void Parameters::fail(const Variable& variable, const std::string& text) const {
  const bool is_constant = variable.variability == Variability::constant;
  const bool is_parameter = variable.variability == Variability::parameter;
  throw ModelError(model_.file, variable.at,
                   (is_constant    ? "constant "
                    : is_parameter ? "parameter "
                                   : "variable ") +
                       variable.name + " " + text);
}

void Parameters::find(int variable) {
  State& state = states_[index(variable)];
  if (state == State::visiting) fail(model_.variables[index(variable)], "depends on itself");
  if (state != State::unvisited) return;
  const Variable& it = model_.variables[index(variable)];
  const Expression& formula = it.binding ? it.binding : it.start;
  if (!formula) fail(it, "has no value; set it, or give it one in the file");
  if (!it.binding && it.variability == Variability::parameter)
    warnings_.push_back(
        ModelError(model_.file, it.at, "parameter " + it.name + " has no value, its start value is used").what());
  state = State::visiting;
  const bool outer = depends_on_free_;
  const Location outer_at = at_;
  depends_on_free_ = false;
  at_ = it.at;
  const double value = evaluate(*formula);
  const bool is_derived = depends_on_free_;
  depends_on_free_ = outer;
  at_ = outer_at;
  states_[index(variable)] = is_derived ? State::derived : State::known;
  if (is_derived) return;
  if (!std::isfinite(value)) fail(it, "has a value that is not finite");
  values_[index(variable)] = value;
}

// The initial guess of a free parameter.
double Parameters::guess(int variable) {
  double& value = values_[index(variable)];
  if (!std::isnan(value)) return value;
  const Variable& it = model_.variables[index(variable)];
  const Expression& formula = it.start ? it.start : it.binding;
  value = 0.0;  // for mutually dependent guesses
  const double found = formula ? evaluate(*formula) : 0.0;
  if (std::isfinite(found)) value = found;
  return value;
}

double Parameters::value(const Expression& expression) {
  at_ = expression->at;
  return evaluate(*expression);
}

std::optional<double> Parameters::start(int variable) {
  const auto given = given_starts_.find(variable);
  if (given != given_starts_.end()) return given->second;
  const Variable& it = model_.variables[index(variable)];
  if (is_free(variable) && (it.start || it.binding)) return guess(variable);
  if (!it.start) return std::nullopt;
  at_ = it.at;
  depends_on_free_ = false;
  const double value = evaluate(*it.start);
  if (std::isfinite(value)) return value;
  if (!depends_on_free_) fail(it, "has a start value that is not finite");
  return 0.0;
}

double Parameters::evaluate(const Node& node) {
  if (node.operation == Operation::number) return node.value;
  if (node.operation == Operation::variable) {
    if (states_[index(node.index)] == State::other)
      throw ModelError(
          model_.file, at_,
          "depends on " + model_.variables[index(node.index)].name + ", which is neither a constant nor a parameter");
    find(node.index);
    const State state = states_[index(node.index)];
    if (state == State::free || state == State::derived) depends_on_free_ = true;
    if (state == State::free) return guess(node.index);
    return state == State::derived ? evaluate(*model_.variables[index(node.index)].binding)
                                   : values_[index(node.index)];
  }
  const auto place = evaluated_.find(&node);
  if (place != evaluated_.end()) return place->second;
  const bool outer = depends_on_free_;
  depends_on_free_ = false;
  const double value = evaluate_operation(node);
  if (!depends_on_free_) evaluated_[&node] = value;  // guessed values become known later
  depends_on_free_ = depends_on_free_ || outer;
  return value;
}

double Parameters::evaluate_operation(const Node& node) {
  const auto operand = [&](std::size_t k) { return evaluate(*node.operands.at(k)); };
  switch (node.operation) {
    case Operation::choose: {  // a branch that is not taken may be undefined
      const double condition = operand(0);
      return std::isnan(condition) ? condition : operand(condition != 0.0 ? 1 : 2);
    }
    case Operation::and_:
    case Operation::or_: {
      const double a = operand(0), deciding = node.operation == Operation::or_ ? 1.0 : 0.0;
      return a == deciding ? deciding : applied(node.operation, a, operand(1), 0.0);
    }
    case Operation::derivative: return 0.0;
    case Operation::previous: {
      const Node variable{Operation::variable, 0.0, node.index, {}, node.at};
      return evaluate(variable);
    }
    case Operation::time:
    case Operation::sample:
    case Operation::initial:
    case Operation::terminal:
      throw ModelError(model_.file, node.at.line > 0 ? node.at : at_,
                       "a constant or parameter cannot depend on time");
    default: break;
  }
  const double a = operand(0);
  const double b = num_operands(node.operation) == 2 ? operand(1) : 0.0;
  return applied(node.operation, a, b, 0.0);
}

}  // namespace sfdae::cli
