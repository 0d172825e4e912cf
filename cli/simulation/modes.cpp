// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/modes.h"

#include <algorithm>
#include <unordered_set>

#include "simulation/recording.h"
#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Kept solvers; a model with more modes meets few of them again.
constexpr std::size_t max_modes = 64;

}  // namespace

int Mode::make_consistent(sfdae::Point& point, const std::vector<int>& fixed) {
  const bool has_fixed = std::find(fixed.begin(), fixed.end(), 1) != fixed.end();
  options.initial_values = has_fixed ? SFDAE_INITIAL_FIXED : SFDAE_INITIAL_NEAREST;
  options.fixed = has_fixed ? fixed : std::vector<int>();
  solver.set_options(options);
  return solver.make_consistent(point);
}

Modes::Modes(const System& system, const sfdae::Options& options, bool has_free)
    : system_(system), options_(options), has_free_(has_free), unknowns_(system.unknowns) {
  if (has_free) unknowns_.insert(unknowns_.end(), system.free_parameters.begin(), system.free_parameters.end());
  if (unknowns_.empty()) unknowns_.push_back(-1);
  std::vector<Formula> all;
  for (const Residual& residual : system.residuals) all.push_back(residual.formula);
  const std::vector<Formula> parts = system.formulas.parts(all);
  std::unordered_set<Formula> calculated;  // operands of what is not a relation
  for (Formula part : parts) {
    const Operation operation = system.formulas[part].operation;
    if (is_relation(operation) || operation == Operation::equal || operation == Operation::not_equal) continue;
    calculated.insert(system.formulas[part].operands.begin(), system.formulas[part].operands.end());
  }
  for (Formula part : parts) {
    const FormulaNode& node = system.formulas[part];
    if (node.operands[0] >= 0 || (node.dependence & on_discrete) == 0) continue;
    (is_parameter(part, calculated.count(part) != 0) ? parameters_ : key_).push_back(part);
  }
}

// What has many values is a parameter, what chooses branches makes a mode. Integers that are only compared do that.
bool Modes::is_parameter(Formula formula, bool is_calculated_with) const {
  const FormulaNode& node = system_.formulas[formula];
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
  if (node.operation == Operation::variable) return system_.model.variables[at(node.index)].name;
  if (node.operation == Operation::previous) return "pre(" + system_.model.variables[at(node.index)].name + ")";
  return system_.switches[at(node.index)].text + " " + std::to_string(node.index);
}

namespace {

double value_of(const FormulaNode& node, const Values& values) {
  switch (node.operation) {
    case Operation::variable: return values.variable[at(node.index)];
    case Operation::previous: return values.previous[at(node.index)];
    case Operation::sample: return values.samples[at(node.index)];
    case Operation::initial: return values.is_initial ? 1.0 : 0.0;
    case Operation::terminal: return values.is_terminal ? 1.0 : 0.0;
    default: return values.switches[at(node.index)];
  }
}

}  // namespace

std::vector<double> Modes::read(const std::vector<Formula>& leaves, const Values& values) const {
  std::vector<double> result;
  for (Formula leaf : leaves) result.push_back(value_of(system_.formulas[leaf], values));
  return result;
}

std::vector<double> Modes::equations_key(const Values& values) const {
  std::vector<double> result = read(key_, values);
  for (Formula leaf : parameters_) result.push_back(value_of(system_.formulas[leaf], values));
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
  const std::vector<double> wanted = read(parameters_, values);
  if (modes_.size() >= max_modes) modes_.clear();
  std::shared_ptr<Mode>& mode = modes_[read(key_, values)];
  if (!mode) {
    mode = recorded(values);
    mode->parameters = wanted;
  }
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (mode->parameters[i] != wanted[i]) {
      const std::string name = parameter_name(parameters_[i]);
      double known = 0.0;  // not there: it occurs in branches alone that are not taken in this mode
      const bool occurs = sfdae_get_parameter(mode->solver.get(), name.c_str(), &known) == SFDAE_OK;
      if (occurs) mode->solver.set_parameter(name, wanted[i]);
      mode->parameters[i] = wanted[i];
    }
  return mode;
}

std::shared_ptr<Mode> Modes::recorded(const Values& values) const {
  const int num_free = has_free_ ? static_cast<int>(system_.free_parameters.size()) : 0;
  const bool has_dummy = unknowns_.front() < 0;
  const int n = num_unknowns(), m = static_cast<int>(system_.residuals.size());
  sfdae::NonlinearProblem problem(m + num_free + (has_dummy ? 1 : 0), n);
  problem.equations = [&](const sfdae::Expression& t, sfdae::ConstExpressions x, sfdae::ConstExpressions xdot,
                          sfdae::Expressions F) {
    std::unordered_map<Formula, std::string> names;
    for (Formula formula : parameters_) names[formula] = parameter_name(formula);
    std::vector<int> unknown_of(system_.model.variables.size(), -1);
    for (int j = 0; j < n; ++j)
      if (unknowns_[at(j)] >= 0) unknown_of[at(unknowns_[at(j)])] = j;
    Recording(system_, values, names).record(unknown_of, t, x, xdot, F);
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
