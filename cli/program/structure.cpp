// SPDX-License-Identifier: BSD-3-Clause
#include "program/structure.h"

#include <algorithm>
#include <map>
#include <unordered_set>
#include <vector>

namespace sfdae::cli {

namespace {

// Equations and unknowns by number; orders[i][j] is the highest derivative of unknown j in equation i.
struct Pattern {
  std::vector<std::map<std::size_t, int>> orders;
  std::size_t num_unknowns = 0;
};

// Shared parts of formulas are visited once.
void collect(const Equation& equation, const std::vector<std::size_t>& unknown_of,
             std::map<std::size_t, int>& orders) {
  std::unordered_set<const Node*> seen;
  std::vector<const Node*> open{equation.left.get(), equation.right.get()};
  while (!open.empty()) {
    const Node& node = *open.back();
    open.pop_back();
    if (!seen.insert(&node).second) continue;
    for (const Expression& operand : node.operands) open.push_back(operand.get());
    const bool is_derivative = node.operation == Operation::derivative;
    if (!is_derivative && node.operation != Operation::variable) continue;
    const std::size_t unknown = unknown_of[static_cast<std::size_t>(node.index)];
    if (unknown == unknown_of.size()) continue;
    const auto [place, is_new] = orders.emplace(unknown, is_derivative ? 1 : 0);
    if (!is_new && is_derivative) place->second = 1;
  }
}

bool is_unknown(const Variable& variable) {
  return variable.variability == Variability::continuous && !variable.is_input;
}

Pattern pattern_of(const FlatModel& model) {
  Pattern pattern;
  std::vector<std::size_t> unknown_of(model.variables.size(), model.variables.size());
  for (std::size_t v = 0; v < model.variables.size(); ++v)
    if (is_unknown(model.variables[v])) unknown_of[v] = pattern.num_unknowns++;
  for (const Equation& equation : model.equations) {
    const Node& left = *equation.left;
    // Equations of discrete variables hold between events.
    if (left.operation == Operation::variable &&
        model.variables[static_cast<std::size_t>(left.index)].variability == Variability::discrete)
      continue;
    pattern.orders.emplace_back();
    collect(equation, unknown_of, pattern.orders.back());
  }
  return pattern;
}

// Matches equations, differentiated as often as necessary, with the highest derivatives of unknowns.
class Matching {
 public:
  explicit Matching(const Pattern& pattern)
      : pattern_(pattern),
        differentiations_(pattern.orders.size()),
        highest_(pattern.num_unknowns),
        equation_of_(pattern.num_unknowns, pattern.orders.size()) {
    for (const auto& orders : pattern.orders)
      for (const auto& [unknown, order] : orders) highest_[unknown] = std::max(highest_[unknown], order);
  }

  // Differentiates the unmatched equations until this equation can be matched. If a matching exists, there are fewer
  // rounds than equations.
  bool add(std::size_t equation) {
    for (std::size_t round = 0; round <= pattern_.orders.size(); ++round) {
      if (add_as_it_is(equation)) return true;
      for (std::size_t j = 0; j < seen_unknowns_.size(); ++j) highest_[j] += seen_unknowns_[j];
      for (std::size_t i = 0; i < seen_equations_.size(); ++i) differentiations_[i] += seen_equations_[i];
    }
    return false;
  }

  bool add_as_it_is(std::size_t equation) {
    seen_equations_.assign(pattern_.orders.size(), 0);
    seen_unknowns_.assign(pattern_.num_unknowns, 0);
    return augment(equation);
  }

  int index() const {
    const int most = *std::max_element(differentiations_.begin(), differentiations_.end());
    return most + (std::find(highest_.begin(), highest_.end(), 0) != highest_.end() ? 1 : 0);
  }

 private:
  // The recursion depth is at most the number of equations.
  bool augment(std::size_t equation) {
    seen_equations_[equation] = 1;
    for (const auto& [unknown, order] : pattern_.orders[equation]) {
      if (seen_unknowns_[unknown] != 0 || order + differentiations_[equation] < highest_[unknown]) continue;
      seen_unknowns_[unknown] = 1;
      if (equation_of_[unknown] == pattern_.orders.size() || augment(equation_of_[unknown])) {
        equation_of_[unknown] = equation;
        return true;
      }
    }
    return false;
  }

  const Pattern& pattern_;
  std::vector<int> differentiations_, highest_;
  std::vector<std::size_t> equation_of_;  // the number of equations: none
  std::vector<int> seen_equations_, seen_unknowns_;
};

// Tells whether equations can be matched with unknowns at all, with or without derivatives.
bool has_matching(Pattern pattern) {
  for (auto& orders : pattern.orders)
    for (auto& [unknown, order] : orders) order = 0;
  Matching matching(pattern);
  for (std::size_t i = 0; i < pattern.orders.size(); ++i)
    if (!matching.add_as_it_is(i)) return false;
  return true;
}

}  // namespace

std::optional<int> structural_index(const FlatModel& model) {
  const Pattern pattern = pattern_of(model);
  if (pattern.orders.empty() || pattern.orders.size() != pattern.num_unknowns || !has_matching(pattern))
    return std::nullopt;
  Matching matching(pattern);
  for (std::size_t i = 0; i < pattern.orders.size(); ++i)
    if (!matching.add(i)) return std::nullopt;
  return matching.index();
}

}  // namespace sfdae::cli
