// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/output.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <unordered_map>

#include "simulation/failure.h"
#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Smaller violations of bounds, relative to the variable's size, are rounding and integration errors.
constexpr double bound_tolerance = 1e-6;
// Whole numbers up to this are exact.
constexpr double largest_integer = 9007199254740992.0;

// Explains why a value is not an Integer; empty if it is not finite.
std::string why_no_integer(double value) {
  if (!std::isfinite(value)) return "";
  return value == std::floor(value) ? ", beyond 2^53, up to which Integers are exact"
                                    : ", but its type is not Real and needs a whole number";
}

}  // namespace

Output::Output(const System& system, bool keeps_aliases, Discrete& discrete, Result& result)
    : system_(system),
      discrete_(discrete),
      result_(result),
      bounds_(system.formulas),
      is_outside_(system.checked.size(), 0) {
  for (const CheckedVariable& it : system.checked) {
    bounds_.add(it.min);
    bounds_.add(it.max);
  }
  for (int v = 0; v < static_cast<int>(system.model.variables.size()); ++v) {
    const Variable& variable = system.model.variables[at(v)];
    const bool is_parameter =
        variable.variability == Variability::constant || variable.variability == Variability::parameter;
    const bool is_discrete = variable.type != Type::real || variable.variability == Variability::discrete;
    const bool is_value = system.formulas.is_number(system.values[at(v)]);
    if ((is_parameter && is_value) || (variable.is_input && !is_value)) continue;
    if (!keeps_aliases && !is_parameter && !is_discrete && !system.is_unknown(v)) continue;
    columns_.push_back(v);
    Trajectory& trajectory = result.trajectory;
    trajectory.names.push_back(variable.name);
    trajectory.units.push_back(variable.unit);
    trajectory.descriptions.push_back(variable.description);
    trajectory.is_discrete.push_back(is_discrete || is_parameter);
  }
}

void Output::add(Values& values, double t) {
  discrete_.complete(values);
  check_values(values);
  Trajectory& trajectory = result_.trajectory;
  trajectory.t.push_back(t);
  for (int v : columns_) trajectory.values.push_back(values.variable[at(v)] + 0.0);  // turns -0 into 0
  check_bounds(values);
}

bool Output::is_defined(int variable, const Values& values) const {
  const double value = values.variable[at(variable)];
  const bool is_real = system_.model.variables[at(variable)].type == Type::real;
  return std::isfinite(value) && (is_real || (value == std::floor(value) && std::fabs(value) <= largest_integer));
}

bool Output::is_defined(Values& values) const {
  discrete_.complete(values);
  return std::all_of(columns_.begin(), columns_.end(), [&](int v) { return is_defined(v, values); });
}

void Output::check_values(const Values& values) const {
  int wrong = -1;
  std::size_t fewest_parts = 0;  // wrong values propagate: the one with the fewest parts is the cause
  for (int v : columns_) {
    if (is_defined(v, values)) continue;
    const std::size_t num_parts = system_.formulas.parts({system_.values[at(v)]}).size();
    if (wrong >= 0 && num_parts >= fewest_parts) continue;
    wrong = v;
    fewest_parts = num_parts;
  }
  if (wrong < 0) return;
  const Variable& variable = system_.model.variables[at(wrong)];
  const double value = values.variable[at(wrong)];
  throw Failure(Outcome::not_finished, SFDAE_OK,
                variable.name + " is " + to_text(value) + " at t = " + to_text(values.t) + why_no_integer(value) +
                    cause(wrong, values));
}

// The first undefined operation and the equation that gives the variable, if known.
std::string Output::cause(int variable, const Values& values) const {
  const FlatModel& model = system_.model;
  const Location defined_at = system_.defined_at[at(variable)];
  std::string equation_text;
  for (const Equation& equation : model.equations)
    if (defined_at.line > 0 && equation.at.line == defined_at.line && equation.at.column == defined_at.column) {
      equation_text = ": " + to_text(equation.left, model) + " = " + to_text(equation.right, model);
      break;
    }
  return undefined_operation(variable, values) + " (" +
         place(model, defined_at.line > 0 ? defined_at : model.variables[at(variable)].at) + equation_text + ")";
}

std::string Output::undefined_operation(int variable, const Values& values) const {
  Formula value = system_.values[at(variable)];
  for (const DiscreteAssignment& assignment : system_.at_events.discrete)
    if (assignment.variable == variable) value = assignment.value;
  const std::vector<Formula> parts = system_.formulas.parts({value});
  Tape tape(system_.formulas);
  std::unordered_map<Formula, int> number_of;
  for (Formula part : parts) number_of[part] = tape.add(part);
  tape.evaluate(values);
  const auto number = [](double x) {
    const auto size = std::make_shared<const Node>(Node{Operation::number, std::fabs(x), -1, {}, {}});
    return x < 0.0 ? std::make_shared<const Node>(Node{Operation::negate, 0.0, -1, {size}, {}}) : size;
  };
  for (Formula part : parts) {
    const FormulaNode& node = system_.formulas[part];
    if (std::isfinite(tape[number_of[part]]) || node.operands[0] < 0) continue;
    Node undefined{node.operation, 0.0, -1, {}, {}};
    bool all_finite = true;
    for (Formula operand : node.operands) {
      if (operand < 0) continue;
      all_finite = all_finite && std::isfinite(tape[number_of[operand]]);
      undefined.operands.push_back(number(tape[number_of[operand]]));
    }
    if (all_finite) return ": " + to_text(std::make_shared<const Node>(undefined), system_.model) + " is not finite";
  }
  return "";
}

void Output::check_bounds(const Values& values) {
  bounds_.evaluate(values);
  for (std::size_t i = 0; i < system_.checked.size(); ++i) {
    const CheckedVariable& it = system_.checked[i];
    const double value = values.variable[at(it.variable)];
    const double tolerance = bound_tolerance * (system_.sizes.nominal[at(it.variable)] + std::fabs(value));
    const double min = bounds_[2 * static_cast<int>(i)], max = bounds_[2 * static_cast<int>(i) + 1];
    if (is_outside_[i] != 0 || (value >= min - tolerance && value <= max + tolerance)) continue;
    is_outside_[i] = 1;
    const Variable& variable = system_.model.variables[at(it.variable)];
    const bool is_low = value < min;
    const bool is_parameter = variable.variability == Variability::parameter;
    result_.warnings.push_back(place(system_.model, variable.at) + (is_parameter ? ": parameter " : ": ") +
                               variable.name + " is " + to_text(value) + " at t = " + to_text(values.t) +
                               (is_low ? ", below min = " : ", above max = ") + to_text(is_low ? min : max));
  }
}

}  // namespace sfdae::cli
