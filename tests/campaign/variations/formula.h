// Formulas in t, unknowns and their derivatives: built by operators, differentiated symbolically, printed as text.
// They have a common owner, Formulas; equal formulas are one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "spline.h"

namespace campaign {

enum class Operation {
  number,
  time,
  unknown,  // number `index`
  slope,    // its derivative with respect to t
  add,
  subtract,
  multiply,
  divide,
  power,  // a^index, index >= 2
  exp,
  sqrt,
  sin,
  cos,
  tanh,
  atan,
  sinh,
  cosh,
  abs,
  minimum,
  maximum,
  choose,  // a < b ? c : d
  table,   // derivative of order `order` of spline number `index` at a
  opaque,  // b, which is function number `index` of the problem at a: the library sees no formula of it
};

struct Node {
  Operation operation = Operation::number;
  int a = -1, b = -1, c = -1, d = -1;
  double value = 0.0;
  int index = 0, order = 0;

  auto key() const { return std::make_tuple(static_cast<int>(operation), a, b, c, d, value, index, order); }
  bool operator<(const Node& other) const { return key() < other.key(); }
};

class Formulas;

struct Formula {
  Formulas* owner = nullptr;
  int node = -1;
};

// A function u -> F(u) that the library calls as a callback of the user's.
struct OpaqueFunction {
  std::string name;
  std::shared_ptr<Formulas> formulas;
  int root = -1;  // in terms of unknown 0
};

class Formulas {
 public:
  Formula number(double value);
  Formula time() { return add({Operation::time}); }
  Formula unknown(int index) { return add_indexed(Operation::unknown, index); }
  Formula slope(int index) { return add_indexed(Operation::slope, index); }
  Formula add(const Node& node);
  Formula add_table(Formula a, const Spline& spline);
  Formula add_opaque(Formula argument, Formula value, const OpaqueFunction& function);

  const Node& node(int index) const { return nodes_[static_cast<std::size_t>(index)]; }
  int size() const { return static_cast<int>(nodes_.size()); }
  const std::vector<Spline>& splines() const { return splines_; }
  const std::vector<OpaqueFunction>& functions() const { return functions_; }
  bool is_number(int index, double value) const;
  std::string text(Formula formula, const std::vector<std::string>& names) const;

 private:
  Formula add_indexed(Operation operation, int index);

  std::vector<Node> nodes_;
  std::map<Node, int> known_;
  std::vector<Spline> splines_;
  std::vector<OpaqueFunction> functions_;
};

Formula operator+(Formula a, Formula b);
Formula operator-(Formula a, Formula b);
Formula operator*(Formula a, Formula b);
Formula operator/(Formula a, Formula b);
inline Formula operator+(Formula a, double b) { return a + a.owner->number(b); }
inline Formula operator-(Formula a, double b) { return a - a.owner->number(b); }
inline Formula operator*(double a, Formula b) { return b.owner->number(a) * b; }
inline Formula operator/(Formula a, double b) { return a / a.owner->number(b); }
inline Formula operator+(double a, Formula b) { return b.owner->number(a) + b; }
inline Formula operator-(double a, Formula b) { return b.owner->number(a) - b; }
inline Formula operator/(double a, Formula b) { return b.owner->number(a) / b; }
Formula power(Formula a, int exponent);
// A function of one argument, Operation::exp ... Operation::abs.
Formula apply(Operation operation, Formula a);
inline Formula exp(Formula a) { return apply(Operation::exp, a); }
inline Formula sqrt(Formula a) { return apply(Operation::sqrt, a); }
inline Formula sin(Formula a) { return apply(Operation::sin, a); }
inline Formula cos(Formula a) { return apply(Operation::cos, a); }
inline Formula tanh(Formula a) { return apply(Operation::tanh, a); }
inline Formula atan(Formula a) { return apply(Operation::atan, a); }
inline Formula sinh(Formula a) { return apply(Operation::sinh, a); }
inline Formula abs(Formula a) { return apply(Operation::abs, a); }
Formula minimum(Formula a, Formula b);
Formula maximum(Formula a, Formula b);

// The partial derivative by t (Operation::time), an unknown or a slope.
Formula derivative(Formula formula, Operation variable, int index = 0);

}  // namespace campaign
