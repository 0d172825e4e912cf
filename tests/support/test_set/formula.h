// SPDX-License-Identifier: BSD-3-Clause
// Formulas as text, read into a tree that can be evaluated with any scalar type.
//
//   sum     = product { (+|-) product }
//   product = sign { (*|/) sign }
//   sign    = [+|-] sign | power
//   power   = atom [ ** integer ]
//   atom    = number | name | t | x[j] | xd[j] | function ( sum ) | ( sum )        function: sin cos exp sqrt
#ifndef SFDAE_TESTS_FORMULA_H
#define SFDAE_TESTS_FORMULA_H

#include <cmath>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "scalar.h"

namespace sfdae_test {

// What the names in formulas stand for; x and xdot may be null where no formula asks for them.
template <class V>
struct FormulaScope {
  V t;
  const V* x = nullptr;
  const V* xdot = nullptr;
  std::map<std::string, V, std::less<>> names = {};
};

class Formula {
 public:
  // Throws std::runtime_error that tells the position.
  explicit Formula(std::string_view source);

  // Throws std::runtime_error for unknown names. Everything is evaluated anew in each call.
  template <class V>
  V evaluate(const FormulaScope<V>& scope) const {
    return evaluate(scope, nodes_.size() - 1);
  }

 private:
  friend class FormulaReader;
  enum class Kind { number, name, t, x, xdot, add, subtract, multiply, divide, negate, power, sin, cos, exp, sqrt };
  struct Node {
    Kind kind;
    std::size_t left = 0, right = 0;  // operands; left is the j of x[j] and xd[j]
    double number = 0.0;              // also the exponent
    std::string name = {};
  };

  template <class V>
  V evaluate(const FormulaScope<V>& scope, std::size_t at) const;
  template <class V>
  V leaf(const FormulaScope<V>& scope, const Node& node) const;

  std::vector<Node> nodes_;  // operands before operators
};

template <class V>
V Formula::leaf(const FormulaScope<V>& scope, const Node& node) const {
  switch (node.kind) {
    case Kind::number: return V(node.number);
    case Kind::t: return scope.t;
    case Kind::x:
    case Kind::xdot: {
      const V* variable = node.kind == Kind::x ? scope.x : scope.xdot;
      if (variable == nullptr) throw std::runtime_error("formula: no unknowns here");
      return variable[node.left];
    }
    default: {
      const auto found = scope.names.find(node.name);
      if (found == scope.names.end()) throw std::runtime_error("formula: unknown name " + node.name);
      return found->second;
    }
  }
}

template <class V>
V Formula::evaluate(const FormulaScope<V>& scope, std::size_t at) const {
  using std::sin, std::cos, std::exp, std::sqrt, std::pow;
  const Node& node = nodes_[at];
  if (node.kind <= Kind::xdot) return leaf(scope, node);
  const V a = evaluate(scope, node.left);
  switch (node.kind) {
    case Kind::add: return a + evaluate(scope, node.right);
    case Kind::subtract: return a - evaluate(scope, node.right);
    case Kind::multiply: return a * evaluate(scope, node.right);
    case Kind::divide: return a / evaluate(scope, node.right);
    case Kind::negate: return -a;
    case Kind::power: return pow(a, node.number);
    case Kind::sin: return sin(a);
    case Kind::cos: return cos(a);
    case Kind::exp: return exp(a);
    default: return sqrt(a);
  }
}

}  // namespace sfdae_test

#endif
