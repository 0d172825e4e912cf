// Derivatives of a recorded expression.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/symbolic_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Formulas in C++ notation.
struct Term {
  Recorder& recorder;
  int node;
  Term with(Operation operation, int other = -1) const { return {recorder, recorder.apply(operation, node, other)}; }
  Term number(double value) const { return {recorder, recorder.constant(value)}; }
};
Term operator+(Term a, Term b) { return a.with(Operation::add, b.node); }
Term operator-(Term a, Term b) { return a.with(Operation::subtract, b.node); }
Term operator*(Term a, Term b) { return a.with(Operation::multiply, b.node); }
Term operator/(Term a, Term b) { return a.with(Operation::divide, b.node); }
Term operator-(Term a) { return a.with(Operation::negate); }

using Adjoints = std::array<int, 3>;  // of operands; -1: none

// Terms that the adjoint `y` of the value v = f(a, b, c) adds to the adjoints of its operands.
Adjoints adjoints_of_operands(Recorder& recorder, const Node& f, int v_node, int y_node) {
  const Term v{recorder, v_node}, y{recorder, y_node}, a{recorder, f.a}, b{recorder, f.b};
  const Term one = v.number(1.0);
  switch (f.operation) {
    case Operation::negate: return {(-y).node, -1, -1};
    case Operation::add: return {y.node, y.node, -1};
    case Operation::subtract: return {y.node, (-y).node, -1};
    case Operation::multiply: return {(y * b).node, (y * a).node, -1};
    case Operation::divide: return {(y / b).node, (-(y * v) / b).node, -1};
    // The exponent depends on parameters only.
    case Operation::power: return {(y * b * a.with(Operation::power, (b - one).node)).node, -1, -1};
    case Operation::log_of_base:
    case Operation::log: return {(y / a).node, -1, -1};
    case Operation::log10: return {(y / (v.number(std::log(10.0)) * a)).node, -1, -1};
    case Operation::sqrt: return {(y / (v.number(2.0) * v)).node, -1, -1};
    case Operation::exp: return {(y * v).node, -1, -1};
    case Operation::sin: return {(y * a.with(Operation::cos)).node, -1, -1};
    case Operation::cos: return {(-(y * a.with(Operation::sin))).node, -1, -1};
    case Operation::tan: return {(y * (one + v * v)).node, -1, -1};
    case Operation::asin: return {(y / (one - a * a).with(Operation::sqrt)).node, -1, -1};
    case Operation::acos: return {(-y / (one - a * a).with(Operation::sqrt)).node, -1, -1};
    case Operation::atan: return {(y / (one + a * a)).node, -1, -1};
    case Operation::atan2: {
      const Term square = a * a + b * b;
      return {(y * b / square).node, (-(y * a) / square).node, -1};
    }
    case Operation::sinh: return {(y * a.with(Operation::cosh)).node, -1, -1};
    case Operation::cosh: return {(y * a.with(Operation::sinh)).node, -1, -1};
    case Operation::tanh: return {(y * (one - v * v)).node, -1, -1};
    case Operation::floor: return {-1, -1, -1};
    case Operation::modulo: {  // v = a - q b with an integer q
      const Term q = ((a - v) / b + v.number(0.5)).with(Operation::floor);
      return {y.node, (-(y * q)).node, -1};
    }
    case Operation::choose: {
      const int zero = v.number(0.0).node;
      return {-1, recorder.apply(Operation::choose, f.a, y.node, zero),
              recorder.apply(Operation::choose, f.a, zero, y.node)};
    }
    case Operation::constant:
    case Operation::parameter:
    case Operation::time:
    case Operation::unknown:
    case Operation::derivative: break;  // no operands
    case Operation::function: break;    // see symbolic_gradient
  }
  return {-1, -1, -1};
}

// Term that the adjoint y of v = a^b adds to that of b, which may be a parameter.
int adjoint_of_exponent(Recorder& recorder, const Node& f, int v, int y) {
  const int logarithm = recorder.apply(Operation::log_of_base, f.a);
  return recorder.apply(Operation::multiply, recorder.apply(Operation::multiply, y, v), logarithm);
}

// A node and all nodes it depends on, ascending; in large recordings these are few.
class NodesBelow {
 public:
  NodesBelow(const Recorder& recorder, int node) {
    std::vector<int> next{node};  // a heap
    while (!next.empty()) {
      std::pop_heap(next.begin(), next.end());
      const int i = next.back();
      next.pop_back();
      if (!nodes_.empty() && nodes_.back() == i) continue;
      nodes_.push_back(i);
      const Operands operands = recorder.operands(i);
      for (int k = 0; k < operands.size(); ++k) {
        next.push_back(operands[k]);
        std::push_heap(next.begin(), next.end());
      }
    }
    std::reverse(nodes_.begin(), nodes_.end());
  }
  const std::vector<int>& nodes() const { return nodes_; }
  bool contain(int node) const { return std::binary_search(nodes_.begin(), nodes_.end(), node); }
  std::size_t place_of(int node) const {
    return static_cast<std::size_t>(std::lower_bound(nodes_.begin(), nodes_.end(), node) - nodes_.begin());
  }

 private:
  std::vector<int> nodes_;
};

// Flags of the nodes that depend on the leaves.
std::vector<char> dependents(const Recorder& recorder, const NodesBelow& below, const std::vector<int>& leaves) {
  std::vector<char> depends(below.nodes().size(), 0);
  for (int leaf : leaves)
    if (below.contain(leaf)) depends[below.place_of(leaf)] = 1;
  for (std::size_t place = 0; place < depends.size(); ++place) {
    const Operands operands = recorder.operands(below.nodes()[place]);
    for (int k = 0; k < operands.size(); ++k)
      if (depends[below.place_of(operands[k])] != 0) depends[place] = 1;
  }
  return depends;
}

// Adds change to the sum of a node.
void add(Recorder& recorder, int& sum, int change) { sum = recorder.apply(Operation::add, sum, change); }

}  // namespace

std::vector<int> symbolic_gradient(Recorder& recorder, int node, const std::vector<int>& leaves) {
  const int zero = recorder.constant(0.0);
  const NodesBelow below(recorder, node);
  const std::vector<char> depend = dependents(recorder, below, leaves);
  const auto depends = [&](int i) { return depend[below.place_of(i)] != 0; };
  std::vector<int> adjoint_at(depend.size(), zero), gradient;
  const auto adjoint = [&](int i) -> int& { return adjoint_at[below.place_of(i)]; };
  adjoint(node) = recorder.constant(1.0);
  for (std::size_t place = depend.size(); place-- > 0;) {
    const int i = below.nodes()[place], y = adjoint_at[place];
    if (depend[place] == 0 || y == zero) continue;
    const Node f = recorder.node(i);  // recording moves nodes
    if (f.operation == Operation::function) {
      FunctionCall call = recorder.called(i);
      call.by.push_back(0);
      for (std::size_t k = 0; k < call.arguments.size(); ++k) {
        if (!depends(call.arguments[k])) continue;
        call.by.back() = static_cast<int>(k);
        const int partial = recorder.call(call);
        add(recorder, adjoint(call.arguments[k]), recorder.apply(Operation::multiply, y, partial));
      }
      continue;
    }
    const bool by_exponent = f.operation == Operation::power && depends(f.b);
    const Adjoints change = adjoints_of_operands(recorder, f, i, y);
    const Operands operands(f, {});
    for (int k = 0; k < operands.size(); ++k)
      if (change[index(k)] >= 0 && depends(operands[k])) add(recorder, adjoint(operands[k]), change[index(k)]);
    if (by_exponent) add(recorder, adjoint(f.b), adjoint_of_exponent(recorder, f, i, y));
  }
  for (int leaf : leaves) gradient.push_back(below.contain(leaf) ? adjoint(leaf) : zero);
  return gradient;
}

std::vector<int> symbolic_gradient(Recorder& recorder, int node, int count) {
  std::vector<int> unknowns;
  for (int j = 0; j < count; ++j) unknowns.push_back(recorder.unknown(j));
  return symbolic_gradient(recorder, node, unknowns);
}

std::array<int, 3> symbolic_partials(Recorder& recorder, int node) {
  const Node f = recorder.node(node);
  const int one = recorder.constant(1.0);
  Adjoints partials = adjoints_of_operands(recorder, f, node, one);
  if (f.operation == Operation::power) partials[1] = adjoint_of_exponent(recorder, f, node, one);
  return partials;
}

std::optional<int> symbolic_time_derivative(Recorder& recorder, int node) {
  std::vector<int> leaves, rates;
  for (int i = 0; i <= node; ++i) {
    const Node leaf = recorder.node(i);
    if (leaf.operation == Operation::time) rates.push_back(recorder.constant(1.0));
    else if (leaf.operation == Operation::unknown) rates.push_back(recorder.derivative(leaf.a));
    else if (leaf.operation == Operation::derivative) rates.push_back(-1);
    else continue;
    leaves.push_back(i);
  }
  const std::vector<int> gradient = symbolic_gradient(recorder, node, leaves);
  const int zero = recorder.constant(0.0);
  int sum = zero;
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    if (gradient[k] == zero) continue;
    if (rates[k] < 0) return std::nullopt;
    add(recorder, sum, recorder.apply(Operation::multiply, gradient[k], rates[k]));
  }
  return sum;
}

}  // namespace sfdae::core
