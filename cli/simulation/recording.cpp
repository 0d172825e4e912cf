// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/recording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "simulation/failure.h"
#include "simulation/text.h"

namespace sfdae::cli {

Recording::Recording(const System& system, const Values& values,
                     const std::unordered_map<Formula, DiscreteLeaf>& leaves)
    : system_(system), values_(values), leaves_(leaves) {
  std::vector<Formula> all;
  for (const Residual& residual : system.residuals) all.push_back(residual.formula);
  find_numbers(system.formulas.parts(all));
}

void Recording::find_numbers(const std::vector<Formula>& parts) {
  for (Formula formula : parts) {
    const FormulaNode& node = system_.formulas[formula];
    const auto leaf = leaves_.find(formula);
    if (leaf != leaves_.end()) {
      if (leaf->second.name.empty()) numbers_[formula] = leaf->second.value;
      continue;
    }
    if (node.operands[0] < 0) {
      if (node.operation == Operation::number) numbers_[formula] = node.value;
      continue;
    }
    std::array<double, 3> values{};
    bool all_known = true;
    for (std::size_t k = 0; k < 3; ++k) {
      if (node.operands[k] < 0) continue;
      const auto place = numbers_.find(node.operands[k]);
      all_known = all_known && place != numbers_.end();
      if (place != numbers_.end()) values[k] = place->second;
    }
    if (all_known) numbers_[formula] = applied(node.operation, values[0], values[1], values[2]);
  }
}

std::vector<Formula> Recording::needed() const {
  std::unordered_map<Formula, char> found;
  std::vector<Formula> stack, result;
  const auto visit = [&](Formula formula) {
    if (formula >= 0 && found.try_emplace(formula, 1).second) stack.push_back(formula);
  };
  for (const Residual& residual : system_.residuals) visit(residual.formula);
  while (!stack.empty()) {
    const Formula formula = stack.back();
    stack.pop_back();
    result.push_back(formula);
    if (numbers_.count(formula) != 0 || leaves_.count(formula) != 0) continue;
    const FormulaNode& node = system_.formulas[formula];
    const auto condition = node.operation == Operation::choose ? numbers_.find(node.operands[0]) : numbers_.end();
    if (condition != numbers_.end() && std::isnan(condition->second))
      throw Failure(Outcome::not_finished, SFDAE_OK,
                    "at t = " + to_text(values_.t) + ": the condition " +
                        to_text(system_.formulas, node.operands[0], system_.model) +
                        " is neither true nor false: a part of it is not defined, as sqrt(-1) is");
    if (condition != numbers_.end()) visit(node.operands[condition->second != 0.0 ? 1 : 2]);
    else
      for (Formula operand : node.operands) visit(operand);
  }
  std::sort(result.begin(), result.end());
  return result;
}

void Recording::record(const std::vector<int>& unknown_of, const sfdae::Expression& t, sfdae::ConstExpressions x,
                       sfdae::ConstExpressions xdot, sfdae::Expressions residuals) {
  for (Formula formula : needed()) {
    const FormulaNode& node = system_.formulas[formula];
    sfdae::Expression& result = recorded_[formula];
    const auto number = numbers_.find(formula);
    const auto leaf = leaves_.find(formula);
    if (number != numbers_.end()) result = number->second;
    else if (leaf != leaves_.end()) result = sfdae::parameter(t, leaf->second.name, leaf->second.value);
    else if (node.operation == Operation::time) result = t;
    else if (node.operation == Operation::variable) {
      const int j = unknown_of[at(node.index)];  // none: a free parameter with a known value
      result = j >= 0 ? x[j] : sfdae::Expression(values_.variable[at(node.index)]);
    } else if (node.operation == Operation::derivative) {
      result = xdot[unknown_of[at(node.index)]];
    } else {
      result = operation(node);
    }
  }
  for (std::size_t i = 0; i < system_.residuals.size(); ++i)
    residuals[static_cast<int>(i)] = recorded_.at(system_.residuals[i].formula);
}

sfdae::Expression Recording::operation(const FormulaNode& node) const {
  if (node.operation == Operation::choose) {
    const auto condition = numbers_.find(node.operands[0]);
    if (condition != numbers_.end()) return operand(node, condition->second != 0.0 ? 1 : 2);
    return choose(operand(node, 0), operand(node, 1), operand(node, 2));
  }
  const sfdae::Expression& a = operand(node, 0);
  const sfdae::Expression b = node.operands[1] >= 0 ? operand(node, 1) : sfdae::Expression(0.0);
  switch (node.operation) {
    case Operation::negate: return -a;
    case Operation::abs: return abs(a);
    case Operation::sign: return choose(a, 1.0, choose(-a, -1.0, 0.0));
    case Operation::sqrt: return sqrt(a);
    case Operation::exp: return exp(a);
    case Operation::log: return log(a);
    case Operation::log10: return log(a) * (1.0 / std::numbers::ln10);
    case Operation::sin: return sin(a);
    case Operation::cos: return cos(a);
    case Operation::tan: return tan(a);
    case Operation::asin: return asin(a);
    case Operation::acos: return acos(a);
    case Operation::atan: return atan(a);
    case Operation::sinh: return sinh(a);
    case Operation::cosh: return cosh(a);
    case Operation::tanh: return tanh(a);
    case Operation::not_: return 1.0 - a;
    case Operation::add: return a + b;
    case Operation::subtract: return a - b;
    case Operation::multiply: return a * b;
    case Operation::divide: return a / b;
    case Operation::power: return pow(a, b);
    case Operation::atan2: return atan2(a, b);
    case Operation::min: return min(a, b);
    case Operation::max: return max(a, b);
    case Operation::and_: return choose(a, b, 0.0);
    case Operation::or_: return choose(a, 1.0, b);
    // Relations are 1 or 0. choose tests whether its first operand is greater than 0.
    case Operation::less: return choose(b - a, 1.0, 0.0);
    case Operation::less_equal: return choose(a - b, 0.0, 1.0);
    case Operation::greater: return choose(a - b, 1.0, 0.0);
    case Operation::greater_equal: return choose(b - a, 0.0, 1.0);
    case Operation::equal: return choose(abs(a - b), 0.0, 1.0);
    case Operation::not_equal: return choose(abs(a - b), 1.0, 0.0);
    default: break;
  }
  // Rounding operations on continuous quantities are switches (Import), those on discrete ones are leaves (Modes).
  throw Failure(Outcome::not_analyzed, SFDAE_OK,
                "an operation (number " + std::to_string(static_cast<int>(node.operation)) +
                    ") of quantities that vary between events cannot be recorded; please report this model");
}

}  // namespace sfdae::cli
