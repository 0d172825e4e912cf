// SPDX-License-Identifier: BSD-3-Clause
#include "formula.h"

#include <cmath>
#include <cstdio>

namespace campaign {

Formula Formulas::add(const Node& node) {
  const auto [place, is_new] = known_.try_emplace(node, size());
  if (is_new) nodes_.push_back(node);
  return {this, place->second};
}

Formula Formulas::number(double value) {
  Node node;
  node.value = value == 0.0 ? 0.0 : value;  // no -0, which would be another number
  return add(node);
}

Formula Formulas::add_indexed(Operation operation, int index) {
  Node node;
  node.operation = operation;
  node.index = index;
  return add(node);
}

Formula Formulas::add_table(Formula a, const Spline& spline) {
  splines_.push_back(spline);
  Node node;
  node.operation = Operation::table;
  node.a = a.node;
  node.index = static_cast<int>(splines_.size()) - 1;
  return add(node);
}

Formula Formulas::add_opaque(Formula argument, Formula value, const OpaqueFunction& function) {
  functions_.push_back(function);
  Node node;
  node.operation = Operation::opaque;
  node.a = argument.node;
  node.b = value.node;
  node.index = static_cast<int>(functions_.size()) - 1;
  return add(node);
}

bool Formulas::is_number(int index, double value) const {
  return node(index).operation == Operation::number && node(index).value == value;
}

namespace {

Formula binary(Operation operation, Formula a, Formula b) {
  Node node;
  node.operation = operation;
  node.a = a.node;
  node.b = b.node;
  return a.owner->add(node);
}

const Node& node_of(Formula a) { return a.owner->node(a.node); }
bool is_number(Formula a) { return node_of(a).operation == Operation::number; }
bool is(Formula a, double value) { return a.owner->is_number(a.node, value); }

}  // namespace

Formula operator+(Formula a, Formula b) {
  if (is(a, 0.0)) return b;
  if (is(b, 0.0)) return a;
  if (is_number(a) && is_number(b)) return a.owner->number(node_of(a).value + node_of(b).value);
  return binary(Operation::add, a, b);
}

Formula operator-(Formula a, Formula b) {
  if (is(b, 0.0)) return a;
  if (is_number(a) && is_number(b)) return a.owner->number(node_of(a).value - node_of(b).value);
  return binary(Operation::subtract, a, b);
}

Formula operator*(Formula a, Formula b) {
  if (is(a, 0.0) || is(b, 1.0)) return a;
  if (is(b, 0.0) || is(a, 1.0)) return b;
  if (is_number(a) && is_number(b)) return a.owner->number(node_of(a).value * node_of(b).value);
  return binary(Operation::multiply, a, b);
}

Formula operator/(Formula a, Formula b) {
  if (is(a, 0.0) || is(b, 1.0)) return a;
  return binary(Operation::divide, a, b);
}

Formula power(Formula a, int exponent) {
  if (exponent == 0) return a.owner->number(1.0);
  if (exponent == 1) return a;
  Node node;
  node.operation = Operation::power;
  node.a = a.node;
  node.index = exponent;
  return a.owner->add(node);
}

Formula apply(Operation operation, Formula a) {
  Node node;
  node.operation = operation;
  node.a = a.node;
  return a.owner->add(node);
}

Formula minimum(Formula a, Formula b) { return binary(Operation::minimum, a, b); }
Formula maximum(Formula a, Formula b) { return binary(Operation::maximum, a, b); }

namespace {

Formula choose_less(Formula a, Formula b, Formula c, Formula d) {
  if (c.node == d.node) return c;
  Node node;
  node.operation = Operation::choose;
  node.a = a.node;
  node.b = b.node;
  node.c = c.node;
  node.d = d.node;
  return a.owner->add(node);
}

// The derivative by its argument a of a function of one argument, whose value is y.
Formula outer_derivative(const Node& node, Formula a, Formula y) {
  Formulas& owner = *a.owner;
  switch (node.operation) {
    case Operation::power: return node.index * power(a, node.index - 1);
    case Operation::exp: return y;
    case Operation::sqrt: return 0.5 / y;
    case Operation::sin: return cos(a);
    case Operation::cos: return -1.0 * sin(a);
    case Operation::tanh: return 1.0 - y * y;
    case Operation::atan: return 1.0 / (1.0 + a * a);
    case Operation::sinh: return apply(Operation::cosh, a);
    case Operation::cosh: return sinh(a);
    case Operation::abs: return choose_less(a, owner.number(0.0), owner.number(-1.0), owner.number(1.0));
    default: break;
  }
  Node next = node;  // a table
  ++next.order;
  return owner.add(next);
}

struct Differentiation {
  Formulas& owner;
  Operation variable;
  int index;
  std::map<int, int> known;

  Formula of(int which) {
    const auto place = known.find(which);
    if (place != known.end()) return {&owner, place->second};
    const Formula result = compute(which);
    known[which] = result.node;
    return result;
  }
  Formula at(int which) const { return {&owner, which}; }

  Formula compute(int which) {
    const Node node = owner.node(which);
    if (node.operation == variable && node.index == index) return owner.number(1.0);
    switch (node.operation) {
      case Operation::number:
      case Operation::time:
      case Operation::unknown:
      case Operation::slope: return owner.number(0.0);
      case Operation::add: return of(node.a) + of(node.b);
      case Operation::subtract: return of(node.a) - of(node.b);
      case Operation::multiply: return of(node.a) * at(node.b) + at(node.a) * of(node.b);
      case Operation::divide: return (of(node.a) - at(which) * of(node.b)) / at(node.b);
      case Operation::minimum: return choose_less(at(node.a), at(node.b), of(node.a), of(node.b));
      case Operation::maximum: return choose_less(at(node.a), at(node.b), of(node.b), of(node.a));
      case Operation::choose: return choose_less(at(node.a), at(node.b), of(node.c), of(node.d));
      case Operation::opaque: return of(node.b);
      default: break;
    }
    const Formula inner = of(node.a);
    if (is(inner, 0.0)) return inner;
    return outer_derivative(node, at(node.a), at(which)) * inner;
  }
};

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

const char* function_name(Operation operation) {
  switch (operation) {
    case Operation::exp: return "exp";
    case Operation::sqrt: return "sqrt";
    case Operation::sin: return "sin";
    case Operation::cos: return "cos";
    case Operation::tanh: return "tanh";
    case Operation::atan: return "atan";
    case Operation::sinh: return "sinh";
    case Operation::cosh: return "cosh";
    case Operation::abs: return "abs";
    default: return "?";
  }
}

}  // namespace

Formula derivative(Formula formula, Operation variable, int index) {
  Differentiation differentiation{*formula.owner, variable, index, {}};
  return differentiation.of(formula.node);
}

std::string Formulas::text(Formula formula, const std::vector<std::string>& names) const {
  const Node& node = this->node(formula.node);
  const auto of = [&](int which) { return text({formula.owner, which}, names); };
  switch (node.operation) {
    case Operation::number: return node.value < 0.0 ? "(" + number_text(node.value) + ")" : number_text(node.value);
    case Operation::time: return "t";
    case Operation::unknown: return names[static_cast<std::size_t>(node.index)];
    case Operation::slope: return names[static_cast<std::size_t>(node.index)] + "'";
    case Operation::add: return "(" + of(node.a) + " + " + of(node.b) + ")";
    case Operation::subtract: return "(" + of(node.a) + " - " + of(node.b) + ")";
    case Operation::multiply: return of(node.a) + " * " + of(node.b);
    case Operation::divide: return of(node.a) + " / (" + of(node.b) + ")";
    case Operation::power: return "(" + of(node.a) + ")^" + std::to_string(node.index);
    case Operation::minimum: return "min(" + of(node.a) + ", " + of(node.b) + ")";
    case Operation::maximum: return "max(" + of(node.a) + ", " + of(node.b) + ")";
    case Operation::choose:
      return "(" + of(node.a) + " < " + of(node.b) + " ? " + of(node.c) + " : " + of(node.d) + ")";
    case Operation::table: return "table" + std::to_string(node.index) + "(" + of(node.a) + ")";
    case Operation::opaque: return "callback(" + of(node.b) + ")";
    default: return std::string(function_name(node.operation)) + "(" + of(node.a) + ")";
  }
}

}  // namespace campaign
