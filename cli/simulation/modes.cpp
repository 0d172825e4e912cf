// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/modes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "model/chain_rule.h"
#include "simulation/recording.h"
#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Number of cached solvers; a model with more modes rarely returns to one of them.
constexpr std::size_t max_modes = 64;

}  // namespace

int Mode::make_consistent(sfdae::Point& point, const std::vector<int>& fixed) {
  const bool has_fixed = std::find(fixed.begin(), fixed.end(), 1) != fixed.end();
  options.initial_values = has_fixed ? SFDAE_INITIAL_FIXED : SFDAE_INITIAL_NEAREST;
  options.fixed = has_fixed ? fixed : std::vector<int>();
  solver.set_options(options);
  return solver.make_consistent(point);
}

namespace {

// The library records no rounding operations: rounded values are evaluated outside the recorded equations, like
// discrete variables.
bool is_leaf(const FormulaNode& node) {
  if ((node.dependence & (on_continuous | on_free)) != 0 || (node.dependence & on_discrete) == 0) return false;
  return node.operands[0] < 0 || is_rounding(node.operation);
}

// The formulas contained in residuals, with leaves but without their operands; in ascending order.
std::vector<Formula> recorded_parts(const System& system) {
  std::vector<Formula> stack, result;
  std::vector<char> is_found(at(system.formulas.size()), 0);
  const auto visit = [&](Formula formula) {
    if (formula < 0 || is_found[at(formula)] != 0) return;
    is_found[at(formula)] = 1;
    stack.push_back(formula);
  };
  for (const Residual& residual : system.residuals) visit(residual.formula);
  while (!stack.empty()) {
    const Formula formula = stack.back();
    stack.pop_back();
    result.push_back(formula);
    if (is_leaf(system.formulas[formula])) continue;
    for (Formula operand : system.formulas[formula].operands) visit(operand);
  }
  std::sort(result.begin(), result.end());
  return result;
}

// Flags of all formulas: the value is always a whole number.
std::vector<char> whole_numbers(const System& system) {
  const Formulas& formulas = system.formulas;
  std::vector<char> result(at(formulas.size()), 0);
  for (Formula f = 0; f < formulas.size(); ++f) {
    const FormulaNode& node = formulas[f];
    const auto is_whole = [&](std::size_t k) { return node.operands[k] < 0 || result[at(node.operands[k])] != 0; };
    switch (node.operation) {
      case Operation::number: result[at(f)] = node.value == std::floor(node.value) ? 1 : 0; break;
      case Operation::variable:
      case Operation::previous: {
        const bool is_condition = at(node.index) >= system.model.variables.size();
        result[at(f)] = is_condition || system.model.variables[at(node.index)].type != Type::real ? 1 : 0;
        break;
      }
      case Operation::choose: result[at(f)] = is_whole(1) && is_whole(2) ? 1 : 0; break;
      case Operation::negate:
      case Operation::abs:
      case Operation::add:
      case Operation::subtract:
      case Operation::multiply:
      case Operation::min:
      case Operation::max:
      case Operation::mod:
      case Operation::rem: result[at(f)] = is_whole(0) && is_whole(1) ? 1 : 0; break;
      default: result[at(f)] = is_stepwise(node.operation) ? 1 : 0;
    }
  }
  return result;
}

}  // namespace

Modes::Modes(const System& system, const sfdae::Options& options, bool has_free)
    : system_(system), options_(options), has_free_(has_free), unknowns_(system.unknowns), leaves_(system.formulas) {
  if (has_free) unknowns_.insert(unknowns_.end(), system.free_parameters.begin(), system.free_parameters.end());
  if (unknowns_.empty()) unknowns_.push_back(-1);
  const std::vector<Formula> parts = recorded_parts(system);
  const std::vector<char> is_whole = whole_numbers(system);
  std::unordered_set<Formula> calculated;  // operands of operations other than relations
  for (Formula part : parts) {
    const Operation operation = system.formulas[part].operation;
    if (is_relation(operation) || operation == Operation::equal || operation == Operation::not_equal) continue;
    if (is_leaf(system.formulas[part])) continue;
    calculated.insert(system.formulas[part].operands.begin(), system.formulas[part].operands.end());
  }
  for (Formula part : parts) {
    if (!is_leaf(system.formulas[part])) continue;
    const bool becomes_parameter = is_parameter(part, calculated.count(part) != 0, is_whole[at(part)] != 0);
    (becomes_parameter ? parameters_ : key_).push_back(part);
  }
  for (Formula leaf : key_) leaves_.add(leaf);
  for (Formula leaf : parameters_) leaves_.add(leaf);
}

// Quantities with many values are parameters; those that choose branches, such as Integers in comparisons only, define
// modes.
bool Modes::is_parameter(Formula formula, bool is_calculated_with, bool is_whole) const {
  const FormulaNode& node = system_.formulas[formula];
  if (node.operands[0] >= 0) return is_calculated_with || !is_whole;  // rounded
  switch (node.operation) {
    case Operation::floor:
    case Operation::div: return true;
    case Operation::variable:
    case Operation::previous: {
      if (at(node.index) >= system_.model.variables.size()) return false;
      const Type type = system_.model.variables[at(node.index)].type;
      return type == Type::real || (type == Type::integer && is_calculated_with);
    }
    default: return false;
  }
}

std::string Modes::parameter_name(Formula formula) const {
  const FormulaNode& node = system_.formulas[formula];
  if (node.operands[0] >= 0) return to_text(system_.formulas, formula, system_.model) + " " + std::to_string(formula);
  if (node.operation == Operation::variable) return system_.model.variables[at(node.index)].name;
  if (node.operation == Operation::previous) return "pre(" + system_.model.variables[at(node.index)].name + ")";
  return system_.switches[at(node.index)].text + " " + std::to_string(node.index);
}

std::vector<double> Modes::equations_key(const Values& values) {
  leaves_.evaluate(values);
  std::vector<double> result;
  for (int i = 0; i < leaves_.size(); ++i)  // keys are compared, and NaN != NaN
    result.push_back(std::isnan(leaves_[i]) ? std::numeric_limits<double>::infinity() : leaves_[i]);
  return result;
}

void Modes::to_values(const sfdae::Point& point, Values& values) const {
  values.t = point.t;
  for (std::size_t j = 0; j < unknowns_.size(); ++j) {
    if (unknowns_[j] < 0) continue;
    values.variable[at(unknowns_[j])] = point.x[j];
    if (!point.xdot.empty()) values.derivative[at(unknowns_[j])] = point.xdot[j];
  }
}

void Modes::to_point(const Values& values, sfdae::Point& point) const {
  point.t = values.t;
  point.x.assign(unknowns_.size(), 0.0);
  point.xdot.assign(unknowns_.size(), 0.0);
  for (std::size_t j = 0; j < unknowns_.size(); ++j)
    if (unknowns_[j] >= 0) point.x[j] = values.variable[at(unknowns_[j])];
}

std::shared_ptr<Mode> Modes::at_values(const Values& values) {
  const std::vector<double> all = equations_key(values);
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(key_.size());
  const std::vector<double> key(all.begin(), middle), wanted(middle, all.end());
  if (modes_.size() >= max_modes) modes_.clear();
  std::shared_ptr<Mode>& mode = modes_[key];
  if (!mode) {
    mode = recorded(values, all);
    mode->parameters = wanted;
  }
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (mode->parameters[i] != wanted[i]) {
      const std::string name = parameter_name(parameters_[i]);
      double known = 0.0;  // absent if it occurs only in branches not taken in this mode
      const bool occurs = sfdae_get_parameter(mode->solver.get(), name.c_str(), &known) == SFDAE_OK;
      if (occurs) mode->solver.set_parameter(name, wanted[i]);
      mode->parameters[i] = wanted[i];
    }
  return mode;
}

std::shared_ptr<Mode> Modes::recorded(const Values& values, const std::vector<double>& leaves) const {
  const int num_free = has_free_ ? static_cast<int>(system_.free_parameters.size()) : 0;
  const bool has_dummy = unknowns_.front() < 0;
  const int n = num_unknowns(), m = static_cast<int>(system_.residuals.size());
  sfdae::NonlinearProblem problem(m + num_free + (has_dummy ? 1 : 0), n);
  problem.equations = [&](const sfdae::Expression& t, sfdae::ConstExpressions x, sfdae::ConstExpressions xdot,
                          sfdae::Expressions F) {
    std::unordered_map<Formula, DiscreteLeaf> leaf_of;
    for (std::size_t i = 0; i < key_.size(); ++i)
      leaf_of[key_[i]] = {std::isfinite(leaves[i]) ? leaves[i] : std::numeric_limits<double>::quiet_NaN(), ""};
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      leaf_of[parameters_[i]] = {leaves[key_.size() + i], parameter_name(parameters_[i])};
    std::vector<int> unknown_of(system_.model.variables.size(), -1);
    for (int j = 0; j < n; ++j)
      if (unknowns_[at(j)] >= 0) unknown_of[at(unknowns_[at(j)])] = j;
    Recording(system_, values, leaf_of).record(unknown_of, t, x, xdot, F);
    for (int k = m; k < F.size(); ++k) F[k] = xdot[n - (F.size() - k)];  // free parameters, the dummy: constant
  };
  for (const Residual& residual : system_.residuals)
    problem.equation_names.push_back(place(system_.model, residual.at));
  problem.equation_names.resize(static_cast<std::size_t>(problem.num_equations));
  const auto mode = std::make_shared<Mode>(std::move(problem), options_);
  mode->has_dummy = has_dummy;
  return mode;
}

}  // namespace sfdae::cli
