// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/time_derivative.h"

#include <cassert>
#include <numbers>
#include <vector>

namespace sfdae::cli {

// Operands have smaller numbers than what they are used in: they come first.
Formula TimeDerivative::operator()(Formula formula) {
  for (Formula part : formulas_.parts({formula}))
    if (known_.count(part) == 0) known_[part] = of_part(part);
  return known_.at(formula);
}

Formula TimeDerivative::of_part(Formula formula) {
  const FormulaNode node = formulas_[formula];
  assert(node.operation != Operation::derivative);
  if ((node.dependence & on_continuous) == 0) return formulas_.number(0.0);
  switch (node.operation) {
    case Operation::time: return formulas_.number(1.0);
    case Operation::variable: return of_variable_(node.index);
    case Operation::choose:
      return formulas_.apply(Operation::choose, node.operands[0], known_.at(node.operands[1]),
                             known_.at(node.operands[2]));
    default: return num_operands(node.operation) == 1 ? of_one(node, formula) : of_two(node, formula);
  }
}

Formula TimeDerivative::of_one(const FormulaNode& node, Formula self) {
  const Formula du = known_.at(node.operands[0]);
  if (node.operation == Operation::negate) return formulas_.negate(du);
  return formulas_.multiply(outer(node.operation, node.operands[0], self), du);
}

// The derivative with respect to the only operand u.
Formula TimeDerivative::outer(Operation operation, Formula u, Formula self) {
  const auto number = [&](double value) { return formulas_.number(value); };
  const auto root = [&] {  // sqrt(1 - u^2)
    return formulas_.apply(Operation::sqrt, formulas_.subtract(number(1.0), square(u)));
  };
  switch (operation) {
    case Operation::abs: return formulas_.apply(Operation::sign, u);
    case Operation::sqrt: return divide(number(0.5), self);
    case Operation::exp: return self;
    case Operation::log: return divide(number(1.0), u);
    case Operation::log10: return divide(number(std::numbers::log10e), u);
    case Operation::sin: return formulas_.apply(Operation::cos, u);
    case Operation::cos: return formulas_.negate(formulas_.apply(Operation::sin, u));
    case Operation::tan: return formulas_.add(number(1.0), square(self));
    case Operation::asin: return divide(number(1.0), root());
    case Operation::acos: return divide(number(-1.0), root());
    case Operation::atan: return divide(number(1.0), formulas_.add(number(1.0), square(u)));
    case Operation::sinh: return formulas_.apply(Operation::cosh, u);
    case Operation::cosh: return formulas_.apply(Operation::sinh, u);
    case Operation::tanh: return formulas_.subtract(number(1.0), square(self));
    default: return number(0.0);  // sign, floor, not: constant between their jumps
  }
}

Formula TimeDerivative::of_two(const FormulaNode& node, Formula self) {
  const Formula u = node.operands[0], v = node.operands[1], du = known_.at(u), dv = known_.at(v);
  const auto minus = [&](Formula a, Formula b) { return formulas_.subtract(a, b); };
  const auto times = [&](Formula a, Formula b) { return formulas_.multiply(a, b); };
  switch (node.operation) {
    case Operation::add: return formulas_.add(du, dv);
    case Operation::subtract: return minus(du, dv);
    case Operation::multiply: return formulas_.add(times(du, v), times(u, dv));
    case Operation::divide: return divide(minus(du, times(self, dv)), v);
    case Operation::power: {  // v u^(v - 1) du + u^v log(u) dv
      const Formula lower = formulas_.apply(Operation::power, u, minus(v, formulas_.number(1.0)));
      const Formula first = times(times(v, lower), du);
      if (formulas_.is_number(dv, 0.0)) return first;
      return formulas_.add(first, times(times(self, formulas_.apply(Operation::log, u)), dv));
    }
    case Operation::atan2: return divide(minus(times(du, v), times(u, dv)), formulas_.add(square(u), square(v)));
    case Operation::min:
    case Operation::max: {
      const Operation relation = node.operation == Operation::min ? Operation::less : Operation::greater;
      return formulas_.apply(Operation::choose, formulas_.apply(relation, u, v), du, dv);
    }
    case Operation::div: return formulas_.number(0.0);
    case Operation::mod:
    case Operation::rem: {
      const Formula quotient = divide(u, v);
      const Formula count = node.operation == Operation::mod
                                ? formulas_.apply(Operation::floor, quotient)
                                : formulas_.apply(Operation::div, quotient, formulas_.number(1.0));
      return minus(du, times(count, dv));
    }
    default: return formulas_.number(0.0);  // relations, and, or
  }
}

}  // namespace sfdae::cli
