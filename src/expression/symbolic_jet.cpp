// Taylor coefficients of recorded expressions, recorded themselves.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/symbolic_jet.h"

#include <array>
#include <cassert>
#include <set>

#include "expression/symbolic_gradient.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// The unfinished nodes that a node needs, operands first. Recursion would be as deep as sums are long.
template <class IsDone>
std::set<int> open_operands(const Recorder& recorder, int node, IsDone is_done) {
  std::set<int> open;
  std::vector<int> stack{node};
  while (!stack.empty()) {
    const int next = stack.back();
    stack.pop_back();
    if (is_done(next) || !open.insert(next).second) continue;
    const Operands operands = recorder.operands(next);
    for (int k = 0; k < operands.size(); ++k) stack.push_back(operands[k]);
  }
  return open;
}

}  // namespace

bool has_functions(const Record& record) {
  const auto operands_of = [&record](int i) { return record.operands(i); };
  std::vector<char> is_needed(index(record.num_nodes()), 0);
  for (int i = 0; i < record.m(); ++i) is_needed[index(record.residual(i))] = 1;
  for (int i = record.num_nodes() - 1; i >= 0; --i) {
    if (is_needed[index(i)] == 0) continue;
    if (record.node(i).operation == Operation::function) return true;
    const Operands operands = operands_of(i);
    for (int k = 0; k < operands.size(); ++k) is_needed[index(operands[k])] = 1;
  }
  return false;
}

const SymbolicPartials::Gradient& SymbolicPartials::of(int node) {
  for (int open : open_operands(recorder_, node, [this](int i) { return known_.contains(i); }))
    known_[open] = gradient(open);
  return known_[node];
}

SymbolicPartials::Gradient SymbolicPartials::gradient(int node) {
  const Node v = recorder_.node(node);
  if (v.operation == Operation::unknown || v.operation == Operation::derivative)
    return {{{v.a, v.operation == Operation::derivative}, recorder_.constant(1.0)}};
  Gradient sum;
  if (is_leaf(v.operation)) return sum;
  const int zero = recorder_.constant(0.0);
  if (v.operation == Operation::choose) {
    const Gradient &b = known_[v.b], &c = known_[v.c];
    const auto at = [zero](const Gradient& g, Leaf leaf) { return g.contains(leaf) ? g.at(leaf) : zero; };
    for (const Gradient* branch : {&b, &c})
      for (const auto& [leaf, unused] : *branch)
        sum[leaf] = recorder_.apply(Operation::choose, v.a, at(b, leaf), at(c, leaf));
    return sum;
  }
  const std::array<int, 3> partials = symbolic_partials(recorder_, node);
  const int operands[] = {v.a, v.b, v.c};
  for (int k = 0; k < num_operands(v.operation); ++k)
    for (const auto& [leaf, partial] : known_[operands[k]]) {
      if (partials[index(k)] < 0) continue;
      const int change = recorder_.apply(Operation::multiply, partials[index(k)], partial);
      const auto [place, is_first] = sum.try_emplace(leaf, change);
      if (!is_first) place->second = recorder_.apply(Operation::add, place->second, change);
    }
  std::erase_if(sum, [zero](const auto& entry) { return entry.second == zero; });
  return sum;
}

int SymbolicJet::coefficient(int node, int k) {
  prepare(node, k);
  return known_[node][index(k)];
}

void SymbolicJet::prepare(int node, int k) {
  const auto is_done = [this, k](int i) {
    const auto place = known_.find(i);
    return place != known_.end() && place->second.size() > index(k);
  };
  for (int open : open_operands(from_, node, is_done))
    for (int order = static_cast<int>(known_[open].size()); order <= k; ++order) {
      const int value = compute(open, order);  // recording its operands may change known_
      known_[open].push_back(value);
    }
}

int SymbolicJet::compute_leaf(const Node& node, int k) {
  switch (node.operation) {
    case Operation::unknown: return leaf_(node.a, false, k);
    case Operation::derivative: return leaf_(node.a, true, k);
    case Operation::time: return k == 0 ? to_.time() : number(k == 1 ? 1.0 : 0.0);
    default: break;
  }
  // Parameters of conditions count as 0, as these are not held.
  if (index(node.a) >= parameters_->size()) return number(0.0);
  const Parameter& parameter = (*parameters_)[index(node.a)];
  return k == 0 ? to_.parameter(parameter.name, parameter.value) : number(0.0);
}

// sum over j = first, ..., k of a_j b_(k-j)
int SymbolicJet::convolution(int a, int b, int first, int k) {
  int sum = number(0.0);
  for (int j = first; j <= k; ++j)
    sum = to_.apply(Operation::add, sum, to_.apply(Operation::multiply, coefficient(a, j), coefficient(b, k - j)));
  return sum;
}

// b v = a
int SymbolicJet::quotient(const Node& node, int v, int k) {
  int sum = coefficient(node.a, k);
  for (int j = 1; j <= k; ++j)
    sum = to_.apply(Operation::subtract, sum,
                    to_.apply(Operation::multiply, coefficient(node.b, j), known_[v][index(k - j)]));
  return to_.apply(Operation::divide, sum, coefficient(node.b, 0));
}

// v' = sum of p a' over the operands a, p the derivatives by them.
int SymbolicJet::by_slopes(int node, int k) {
  const Node v = from_.node(node);
  const std::array<int, 3> partials = symbolic_partials(from_, node);
  const int operands[] = {v.a, v.b, v.c};
  int sum = number(0.0);
  for (int i = 0; i < num_operands(v.operation); ++i)
    for (int j = 1; j <= k && partials[index(i)] >= 0; ++j) {
      const int a_j = coefficient(operands[i], j);
      if (to_.number(a_j) == 0.0) continue;
      const int slope = to_.apply(Operation::multiply, number(j), a_j);
      const int product = to_.apply(Operation::multiply, slope, coefficient(partials[index(i)], k - j));
      sum = to_.apply(Operation::add, sum, product);
    }
  return to_.apply(Operation::divide, sum, number(k));
}

int SymbolicJet::compute(int node, int k) {
  const Node v = from_.node(node);
  if (v.operation == Operation::constant) return number(k == 0 ? *from_.number(node) : 0.0);
  if (is_leaf(v.operation)) return compute_leaf(v, k);
  assert(v.operation != Operation::function);
  const auto at = [this](int operand, int order) { return operand < 0 ? -1 : coefficient(operand, order); };
  switch (v.operation) {
    case Operation::negate:
    case Operation::add:
    case Operation::subtract: return to_.apply(v.operation, at(v.a, k), at(v.b, k));
    case Operation::choose: return to_.apply(v.operation, at(v.a, 0), at(v.b, k), at(v.c, k));
    case Operation::multiply: return convolution(v.a, v.b, 0, k);
    case Operation::divide: return quotient(v, node, k);
    default: break;
  }
  return k == 0 ? to_.apply(v.operation, at(v.a, 0), at(v.b, 0)) : by_slopes(node, k);
}

}  // namespace sfdae::core
