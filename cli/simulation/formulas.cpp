// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/formulas.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace sfdae::cli {

std::size_t Formulas::Hash::operator()(const FormulaNode& node) const {
  // Seed: the golden ratio; multiplier: from MurmurHash3's finalizer, which spreads bits well.
  std::uint64_t hash = 0x9e3779b97f4a7c15u;
  const auto mix = [&](std::uint64_t part) {
    hash = (hash ^ part) * 0xff51afd7ed558ccdu;
    hash ^= hash >> 32;
  };
  mix(static_cast<std::uint64_t>(node.operation));
  mix(static_cast<std::uint32_t>(node.index));
  for (Formula operand : node.operands) mix(static_cast<std::uint32_t>(operand));
  mix(std::bit_cast<std::uint64_t>(node.value));
  return static_cast<std::size_t>(hash);
}

Formula Formulas::interned(const FormulaNode& node) {
  const auto [place, is_new] = known_.try_emplace(node, size());
  if (is_new) nodes_.push_back(node);
  return place->second;
}

Formula Formulas::leaf(Operation operation, int index, unsigned dependence) {
  return interned({operation, index, {-1, -1, -1}, 0.0, dependence});
}

Formula Formulas::number(double value) {
  return interned({Operation::number, -1, {-1, -1, -1}, value == 0.0 ? 0.0 : value, on_numbers});
}

Formula Formulas::time() { return leaf(Operation::time, -1, on_continuous); }

Formula Formulas::derivative(int index) { return leaf(Operation::derivative, index, on_continuous | on_derivative); }

int Formulas::add_variable(unsigned dependence) {
  of_variable_.push_back(dependence);
  return static_cast<int>(of_variable_.size()) - 1;
}

Formula Formulas::apply(Operation operation, Formula a, Formula b, Formula c) {
  const std::array<Formula, 3> operands{a, b, c};
  const int count = num_operands(operation);
  bool all_numbers = true;
  std::array<double, 3> values{};
  unsigned dependence = on_numbers;
  for (int k = 0; k < count; ++k) {
    const FormulaNode& operand = nodes_[at(operands[at(k)])];
    all_numbers = all_numbers && operand.operation == Operation::number;
    values[at(k)] = operand.value;
    dependence |= operand.dependence;
  }
  if (all_numbers) {
    const double value = applied(operation, values[0], values[1], values[2]);
    if (std::isfinite(value)) return number(value);  // undefined values may never be evaluated
  }
  const Formula simple = simplified(operation, a, b, c);
  if (simple >= 0) return simple;
  return interned({operation, -1, operands, 0.0, dependence});
}

Formula Formulas::simplified(Operation operation, Formula a, Formula b, Formula c) {
  switch (operation) {
    case Operation::negate: return nodes_[at(a)].operation == Operation::negate ? nodes_[at(a)].operands[0] : -1;
    case Operation::add:
    case Operation::subtract: return simplified_sum(operation, a, b);
    case Operation::multiply:
    case Operation::divide: return simplified_product(operation, a, b);
    case Operation::power: return is_number(b, 1.0) ? a : -1;
    case Operation::not_:
    case Operation::and_:
    case Operation::or_:
    case Operation::choose: return simplified_logic(operation, a, b, c);
    default: return -1;
  }
}

Formula Formulas::simplified_sum(Operation operation, Formula a, Formula b) {
  if (is_number(b, 0.0)) return a;
  if (operation == Operation::add) {
    if (is_number(a, 0.0)) return b;
    if (nodes_[at(b)].operation == Operation::negate) return subtract(a, nodes_[at(b)].operands[0]);
    return -1;
  }
  if (a == b) return number(0.0);
  if (is_number(a, 0.0)) return negate(b);
  if (nodes_[at(b)].operation == Operation::negate) return add(a, nodes_[at(b)].operands[0]);
  return -1;
}

Formula Formulas::simplified_product(Operation operation, Formula a, Formula b) {
  if (is_number(b, 1.0)) return a;
  if (is_number(b, -1.0)) return negate(a);
  if (operation == Operation::divide) return -1;
  if (is_number(a, 1.0)) return b;
  if (is_number(a, -1.0)) return negate(b);
  return is_number(a, 0.0) || is_number(b, 0.0) ? number(0.0) : -1;
}

Formula Formulas::simplified_logic(Operation operation, Formula a, Formula b, Formula c) {
  if (operation == Operation::not_)
    return nodes_[at(a)].operation == Operation::not_ ? nodes_[at(a)].operands[0] : -1;
  if (operation == Operation::choose) {
    if (is_number(a)) return nodes_[at(a)].value != 0.0 ? b : c;
    return b == c ? b : -1;
  }
  if (is_number(b)) std::swap(a, b);
  if (!is_number(a)) return -1;
  const bool decides = (nodes_[at(a)].value != 0.0) == (operation == Operation::or_);
  return decides ? number(operation == Operation::or_ ? 1.0 : 0.0) : b;
}

std::vector<Formula> Formulas::parts(const std::vector<Formula>& of) const {
  mark_.resize(nodes_.size(), 0);
  ++last_mark_;
  std::vector<Formula> stack, result;
  const auto visit = [&](Formula formula) {
    if (formula < 0 || mark_[at(formula)] == last_mark_) return;
    mark_[at(formula)] = last_mark_;
    stack.push_back(formula);
  };
  for (Formula formula : of) visit(formula);
  while (!stack.empty()) {
    const Formula formula = stack.back();
    stack.pop_back();
    result.push_back(formula);
    for (Formula operand : nodes_[at(formula)].operands) visit(operand);
  }
  std::sort(result.begin(), result.end());
  return result;
}

void Formulas::mark_differentiated(const std::vector<Formula>& in, std::vector<char>& flags) const {
  for (Formula part : parts(in))
    if (nodes_[at(part)].operation == Operation::derivative) flags[at(nodes_[at(part)].index)] = 1;
}

Formula Substitution::operator()(Formula formula) {
  if (formula < 0) return formula;
  std::vector<Formula> stack{formula};
  while (!stack.empty()) {
    const Formula f = stack.back();
    if (known_.count(f) != 0) {
      stack.pop_back();
      continue;
    }
    bool is_ready = true;
    for (Formula operand : formulas_[f].operands)
      if (operand >= 0 && known_.count(operand) == 0) {
        stack.push_back(operand);
        is_ready = false;
      }
    if (!is_ready) continue;
    stack.pop_back();
    known_[f] = rebuilt(f);
  }
  return known_.at(formula);
}

Formula Substitution::rebuilt(Formula formula) {
  const FormulaNode node = formulas_[formula];
  if (node.operation == Operation::variable || node.operation == Operation::derivative) {
    const auto place = by_.find(node.index);
    if (place == by_.end()) return formula;
    return place->second[node.operation == Operation::variable ? 0 : 1];
  }
  if (node.operands[0] < 0) return formula;
  std::array<Formula, 3> operands{-1, -1, -1};
  for (std::size_t k = 0; k < 3; ++k)
    if (node.operands[k] >= 0) operands[k] = known_.at(node.operands[k]);
  if (operands == node.operands) return formula;
  return formulas_.apply(node.operation, operands[0], operands[1], operands[2]);
}

}  // namespace sfdae::cli
