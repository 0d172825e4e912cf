// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/expression_pool.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "model/flat_model.h"
#include "model/operations.h"

namespace sfdae::cli {

namespace {

bool makes_events(Operation operation) {
  switch (operation) {
    case Operation::floor:
    case Operation::ceil:
    case Operation::integer:
    case Operation::div:
    case Operation::mod:
    case Operation::rem:
    case Operation::less:
    case Operation::less_equal:
    case Operation::greater:
    case Operation::greater_equal:
    case Operation::equal:
    case Operation::not_equal:
    case Operation::sample: return true;
    default: return false;
  }
}

void mix(size_t& hash, size_t value) { hash ^= value + 0x9e3779b97f4a7c15ULL + (hash << 6) + (hash >> 2); }

}  // namespace

std::optional<double> apply(Operation operation, const std::vector<double>& x) {
  if (x.empty() || operation == Operation::sample) return std::nullopt;
  const auto operand = [&x](size_t k) { return k < x.size() ? x[k] : 0.0; };
  return applied(operation, x[0], operand(1), operand(2));
}

bool is_number(const Expression& e) { return e->operation == Operation::number; }
bool is_number(const Expression& e, double value) { return is_number(e) && e->value == value; }

size_t ExpressionPool::Hash::operator()(const Expression& e) const {
  size_t result = static_cast<size_t>(e->operation);
  mix(result, std::hash<std::uint64_t>()(std::bit_cast<std::uint64_t>(e->value)));
  mix(result, static_cast<size_t>(e->index + 1));
  for (const Expression& operand : e->operands) mix(result, std::hash<const Node*>()(operand.get()));
  return result;
}

bool ExpressionPool::Same::operator()(const Expression& a, const Expression& b) const {
  return a == b || (a->operation == b->operation && a->index == b->index && a->operands == b->operands &&
                    std::bit_cast<std::uint64_t>(a->value) == std::bit_cast<std::uint64_t>(b->value));
}

Expression ExpressionPool::keep(Node node, bool varies) {
  const Expression candidate = std::make_shared<const Node>(std::move(node));
  const auto found = nodes_.find(candidate);
  if (found != nodes_.end()) return found->first;
  Facts result;
  result.varies = varies;
  result.has_events = makes_events(candidate->operation);
  for (const Expression& operand : candidate->operands) {
    const Facts& f = facts(operand);
    result.depth = std::max(result.depth, f.depth + 1);
    result.varies = result.varies || f.varies;
    result.has_events = result.has_events || f.has_events;
  }
  if (candidate->operation == Operation::no_event) result.has_events = false;
  if (result.depth > kMaxDepth)
    throw ModelError(file_, candidate->at,
                     "expands to operations nested deeper than " + std::to_string(kMaxDepth) +
                         " levels; a loop is too long, or introduce variables for parts of the expression");
  if (nodes_.size() >= kMaxNodes)
    throw ModelError(file_, candidate->at,
                     "the model expands to more than " + std::to_string(kMaxNodes / 1'000'000) +
                         " million operations; make arrays or loops smaller");
  nodes_.emplace(candidate, result);
  return candidate;
}

Expression ExpressionPool::number(double value, Location at) {
  Node node;
  node.value = value == 0.0 ? 0.0 : value;  // never -0
  node.at = at;
  return keep(std::move(node), false);
}

Expression ExpressionPool::leaf(Operation operation, Location at) {
  Node node;
  node.operation = operation;
  node.at = at;
  return keep(std::move(node), true);
}

Expression ExpressionPool::variable(Operation operation, int index, bool varies, Location at) {
  Node node;
  node.operation = operation;
  node.index = index;
  node.at = at;
  return keep(std::move(node), varies);
}

Expression ExpressionPool::make(Operation operation, std::vector<Expression> operands, Location at) {
  if (operation != Operation::sample &&
      std::all_of(operands.begin(), operands.end(), [](const Expression& e) { return is_number(e); })) {
    std::vector<double> values;
    for (const Expression& e : operands) values.push_back(e->value);
    const std::optional<double> value = sfdae::cli::apply(operation, values);
    if (value && std::isfinite(*value)) return number(*value, at);
  }
  if (Expression simple = simplified(operation, operands, at)) return simple;
  Node node;
  node.operation = operation;
  node.operands = std::move(operands);
  node.at = at;
  return keep(std::move(node), operation == Operation::sample);
}

// A simpler expression of the same value; none if there is none.
Expression ExpressionPool::simplified(Operation operation, const std::vector<Expression>& x, Location at) {
  switch (operation) {
    case Operation::no_event: return has_events(x[0]) ? nullptr : x[0];
    case Operation::choose:
      if (is_number(x[0])) return x[0]->value != 0.0 ? x[1] : x[2];
      return x[1] == x[2] ? x[1] : nullptr;
    case Operation::not_:
    case Operation::and_:
    case Operation::or_: return simplified_logic(operation, x);
    default: return simplified_arithmetic(operation, x, at);
  }
}

Expression ExpressionPool::simplified_logic(Operation operation, const std::vector<Expression>& x) {
  if (operation == Operation::not_) return x[0]->operation == Operation::not_ ? x[0]->operands[0] : nullptr;
  // true is neutral in `and`, false in `or`; the result is the other operand.
  const double neutral = operation == Operation::and_ ? 1.0 : 0.0;
  for (size_t k = 0; k < 2; ++k)
    if (is_number(x[k])) return x[k]->value == neutral ? x[1 - k] : x[k];
  return x[0] == x[1] ? x[0] : nullptr;
}

Expression ExpressionPool::simplified_arithmetic(Operation operation, const std::vector<Expression>& x, Location at) {
  switch (operation) {
    case Operation::negate: return x[0]->operation == Operation::negate ? x[0]->operands[0] : nullptr;
    case Operation::add:
      if (is_number(x[0], 0.0)) return x[1];
      if (is_number(x[1], 0.0)) return x[0];
      if (x[1]->operation == Operation::negate) return make(Operation::subtract, {x[0], x[1]->operands[0]}, at);
      return nullptr;
    case Operation::subtract:
      if (is_number(x[1], 0.0)) return x[0];
      if (is_number(x[0], 0.0)) return make(Operation::negate, {x[1]}, at);
      if (x[1]->operation == Operation::negate) return make(Operation::add, {x[0], x[1]->operands[0]}, at);
      return nullptr;
    case Operation::multiply:
      for (size_t k = 0; k < 2; ++k) {
        if (is_number(x[k], 0.0)) return x[k];
        if (is_number(x[k], 1.0)) return x[1 - k];
        if (is_number(x[k], -1.0)) return make(Operation::negate, {x[1 - k]}, at);
      }
      return nullptr;
    case Operation::divide: return is_number(x[1], 1.0) ? x[0] : nullptr;
    case Operation::power: return is_number(x[1], 1.0) ? x[0] : nullptr;
    default: return nullptr;
  }
}

Expression ExpressionPool::sum(const std::vector<Expression>& terms, Location at) {
  std::vector<Expression> level = terms;
  if (level.empty()) return number(0.0, at);
  while (level.size() > 1) {
    std::vector<Expression> next;
    for (size_t k = 0; k + 1 < level.size(); k += 2)
      next.push_back(make(Operation::add, {level[k], level[k + 1]}, at));
    if (level.size() % 2 == 1) next.push_back(level.back());
    level = std::move(next);
  }
  return level[0];
}

}  // namespace sfdae::cli
