// Derivatives of a recorded expression.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/symbolic_gradient.h"

#include <array>
#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Formulas as C++ writes them.
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

// What the adjoint `y` of the value v = f(a, b, c) adds to those of its operands.
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
  }
  return {-1, -1, -1};
}

}  // namespace

std::vector<int> symbolic_gradient(Recorder& recorder, int node, int count) {
  const int size = node + 1, zero = recorder.constant(0.0);
  std::vector<char> depends(index(size), 0);
  for (int i = 0; i < size; ++i) {
    const Node& f = recorder.node(i);
    if (f.operation == Operation::unknown && f.a < count) depends[index(i)] = 1;
    for (int k = 0; k < num_operands(f.operation); ++k)
      if (depends[index(f.operand(k))] != 0) depends[index(i)] = 1;
  }
  std::vector<int> adjoint(index(size), zero), gradient(index(count), zero);
  adjoint[index(node)] = recorder.constant(1.0);
  for (int i = node; i >= 0; --i) {
    if (depends[index(i)] == 0 || adjoint[index(i)] == zero) continue;
    const Node f = recorder.node(i);  // recording moves nodes
    if (f.operation == Operation::unknown) gradient[index(f.a)] = adjoint[index(i)];
    const Adjoints change = adjoints_of_operands(recorder, f, i, adjoint[index(i)]);
    for (int k = 0; k < num_operands(f.operation); ++k) {
      if (change[index(k)] < 0 || depends[index(f.operand(k))] == 0) continue;
      int& sum = adjoint[index(f.operand(k))];
      sum = recorder.apply(Operation::add, sum, change[index(k)]);
    }
  }
  return gradient;
}

}  // namespace sfdae::core
