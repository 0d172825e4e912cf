// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/classification.h"

#include <algorithm>
#include <numeric>

#include "simulation/matching.h"
#include "simulation/text.h"

namespace sfdae::cli {

namespace {

constexpr int most_named = 8;

class Classification {
 public:
  Classification(System& system, const std::vector<ImportedEquation>& equations,
                 const std::vector<Determined>& determined)
      : system_(system), equations_(equations), determined_(determined) {}

  ClassifiedEquations run() {
    std::vector<std::vector<int>> candidates;
    for (const ImportedEquation& equation : equations_) candidates.push_back(targets(equation));
    const std::vector<int> equation_of = matched(candidates);
    std::vector<int> variable_of(equations_.size(), -1);
    for (std::size_t v = 0; v < equation_of.size(); ++v) {
      if (equation_of[v] >= 0) variable_of[at(equation_of[v])] = static_cast<int>(v);
      else if (determined_[v] == Determined::discretely) fail_undetermined(system_.model.variables[v]);
    }
    for (std::size_t i = 0; i < equations_.size(); ++i) {
      if (variable_of[i] >= 0) result_.discrete.push_back(assignment(equations_[i], variable_of[i]));
      else add_continuous(equations_[i]);
    }
    check_counts();
    return std::move(result_);
  }

 private:
  // The discrete variable that a side of an equation determines: v, not v, -v.
  int target(Formula side) const {
    const Formulas& formulas = system_.formulas;
    FormulaNode node = formulas[side];
    if (node.operation == Operation::not_ || node.operation == Operation::negate) node = formulas[node.operands[0]];
    if (node.operation != Operation::variable || determined_[at(node.index)] != Determined::discretely) return -1;
    return node.index;
  }

  // Purely discrete equations come first: der(x) = n does not determine n if another equation does.
  std::vector<int> matched(const std::vector<std::vector<int>>& candidates) const {
    std::vector<int> order(equations_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_partition(order.begin(), order.end(), [&](int i) {
      const ImportedEquation& equation = equations_[at(i)];
      return !system_.formulas.depends(equation.left, on_continuous) &&
             !system_.formulas.depends(equation.right, on_continuous);
    });
    std::vector<std::vector<int>> sorted;
    for (int i : order) sorted.push_back(candidates[at(i)]);
    std::vector<int> result = matched_equations(sorted, static_cast<int>(determined_.size()));
    for (int& equation : result)
      if (equation >= 0) equation = order[at(equation)];
    return result;
  }

  std::vector<int> targets(const ImportedEquation& equation) const {
    std::vector<int> result;
    for (Formula side : {equation.left, equation.right})
      if (const int variable = target(side); variable >= 0) result.push_back(variable);
    return result;
  }

  DiscreteAssignment assignment(const ImportedEquation& equation, int variable) {
    Formulas& formulas = system_.formulas;
    const bool is_left = target(equation.left) == variable;
    const Formula side = is_left ? equation.left : equation.right, other = is_left ? equation.right : equation.left;
    const Operation operation = formulas[side].operation;
    if (formulas.depends(other, on_continuous)) fail_continuous(system_.model.variables[at(variable)], equation.at);
    return {variable, operation == Operation::variable ? other : formulas.apply(operation, other), equation.at};
  }

  void add_continuous(const ImportedEquation& equation) {
    Formulas& formulas = system_.formulas;
    const Formula residual = formulas.subtract(equation.left, equation.right);
    if (!formulas.depends(residual, on_continuous | on_free) && !formulas.is_number(residual, 0.0)) {
      if (formulas.is_number(residual))
        throw ModelError(
            system_.model.file, equation.at,
            "this equation contains no unknown and does not hold: it says 0 = " + to_text(formulas[residual].value));
      throw ModelError(system_.model.file, equation.at,
                       "this equation of discrete quantities determines none: all are determined elsewhere");
    }
    result_.continuous.push_back({residual, equation.at});
  }

  [[noreturn]] void fail_continuous(const Variable& variable, Location at) const {
    throw ModelError(system_.model.file, at,
                     "the discrete variable " + variable.name +
                         " would change without an event; write what it is equal to without noEvent, or assign it in "
                         "a when clause");
  }

  [[noreturn]] void fail_undetermined(const Variable& variable) const {
    throw ModelError(system_.model.file, variable.at,
                     "no equation determines the discrete variable " + variable.name +
                         "; write it alone on a side of one, or assign it in a when clause");
  }

  void check_counts() const {
    std::vector<int> unknowns;
    for (std::size_t v = 0; v < determined_.size(); ++v)
      if (determined_[v] == Determined::continuously) unknowns.push_back(static_cast<int>(v));
    const std::vector<std::vector<int>> contained = variables_of_equations();
    std::vector<char> occurs(determined_.size(), 0);
    for (const auto& variables : contained)
      for (int v : variables) occurs[at(v)] = 1;
    std::vector<int> missing;
    for (int v : unknowns)
      if (occurs[at(v)] == 0) missing.push_back(v);
    if (!missing.empty())
      throw ModelError(system_.model.file, system_.model.variables[at(missing.front())].at,
                       counts(unknowns.size()) + "; no equation contains " + names(missing));
    if (result_.continuous.size() == unknowns.size()) return;
    const std::vector<int> equation_of = matched_equations(contained, static_cast<int>(determined_.size()));
    std::vector<int> undetermined;
    std::vector<char> is_used(contained.size(), 0);
    for (int v : unknowns) {
      if (equation_of[at(v)] < 0) undetermined.push_back(v);
      else is_used[at(equation_of[at(v)])] = 1;
    }
    std::string text = counts(unknowns.size());
    Location where;
    if (!undetermined.empty()) text += "; nothing is left to determine " + names(undetermined);
    const auto extra = std::find(is_used.begin(), is_used.end(), 0);
    if (extra != is_used.end()) {
      where = result_.continuous[static_cast<std::size_t>(extra - is_used.begin())].at;
      text += "; the equation in line " + std::to_string(where.line) + " is among those that are too many";
    }
    throw ModelError(system_.model.file, where, text);
  }

  std::string counts(std::size_t num_unknowns) const {
    return std::to_string(result_.continuous.size()) + " equations for " + std::to_string(num_unknowns) +
           " continuous unknowns";
  }

  std::string names(const std::vector<int>& variables) const {
    std::string text;
    for (std::size_t k = 0; k < variables.size() && k < most_named; ++k)
      text += (k > 0 ? ", " : "") + system_.model.variables[at(variables[k])].name;
    return variables.size() > most_named ? text + ", ..." : text;
  }

  std::vector<std::vector<int>> variables_of_equations() const {
    std::vector<std::vector<int>> result;
    for (const Residual& residual : result_.continuous) {
      std::vector<int> variables;
      for (Formula part : system_.formulas.parts({residual.formula})) {
        const FormulaNode& node = system_.formulas[part];
        if (node.operation != Operation::variable && node.operation != Operation::derivative) continue;
        if (determined_[at(node.index)] == Determined::continuously) variables.push_back(node.index);
      }
      std::sort(variables.begin(), variables.end());
      variables.erase(std::unique(variables.begin(), variables.end()), variables.end());
      result.push_back(std::move(variables));
    }
    return result;
  }

  System& system_;
  const std::vector<ImportedEquation>& equations_;
  const std::vector<Determined>& determined_;
  ClassifiedEquations result_;
};

}  // namespace

ClassifiedEquations classify(System& system, const std::vector<ImportedEquation>& equations,
                             const std::vector<Determined>& determined) {
  return Classification(system, equations, determined).run();
}

}  // namespace sfdae::cli
