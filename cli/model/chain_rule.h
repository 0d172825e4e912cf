// Chain rule for the operations of expressions; the representation of the terms is a template parameter.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>

#include "model/expression.h"

namespace sfdae::cli {

// Operations whose values are constant between their jumps.
inline bool is_stepwise(Operation operation) {
  switch (operation) {
    case Operation::sign:
    case Operation::floor:
    case Operation::ceil:
    case Operation::integer:
    case Operation::not_:
    case Operation::div:
    case Operation::sample: return true;
    default: return operation >= Operation::less && operation <= Operation::or_;
  }
}

// Algebra has a type Term, number(value), make(operation, u), make(operation, u, v), is_zero(u), and choose(relation,
// u, v, a, b), which is a if u and v satisfy the relation, else b.
template <class Algebra>
class ChainRule {
 public:
  using Term = typename Algebra::Term;

  struct Operand {
    Term value, derivative;
  };

  explicit ChainRule(Algebra& algebra) : algebra_(algebra) {}

  // d/dt of self = operation(u).
  Term of_one(Operation operation, const Operand& u, const Term& self) {
    if (is_stepwise(operation) || algebra_.is_zero(u.derivative)) return number(0.0);
    if (operation == Operation::negate) return make(Operation::negate, u.derivative);
    return times(outer(operation, u.value, self), u.derivative);
  }

  // d/dt of self = operation(u, v).
  Term of_two(Operation operation, const Operand& u, const Operand& v, const Term& self) {
    switch (operation) {
      case Operation::add:
      case Operation::subtract: return make(operation, u.derivative, v.derivative);
      case Operation::multiply: return plus(times(u.derivative, v.value), times(u.value, v.derivative));
      case Operation::divide: return over(minus(u.derivative, times(self, v.derivative)), v.value);
      case Operation::power: return of_power(u, v, self);
      case Operation::atan2:
        return over(minus(times(u.derivative, v.value), times(u.value, v.derivative)),
                    plus(square(u.value), square(v.value)));
      case Operation::min: return algebra_.choose(Operation::less, u.value, v.value, u.derivative, v.derivative);
      case Operation::max: return algebra_.choose(Operation::greater, u.value, v.value, u.derivative, v.derivative);
      case Operation::mod:  // u - floor(u / v) v
        return minus(u.derivative, times(make(Operation::floor, over(u.value, v.value)), v.derivative));
      case Operation::rem: return minus(u.derivative, times(make(Operation::div, u.value, v.value), v.derivative));
      default: return number(0.0);  // stepwise
    }
  }

 private:
  // The derivative with respect to the only operand.
  Term outer(Operation operation, const Term& u, const Term& self) {
    switch (operation) {
      case Operation::abs: return make(Operation::sign, u);
      case Operation::sqrt: return over(number(0.5), self);
      case Operation::exp: return self;
      case Operation::log: return over(number(1.0), u);
      case Operation::log10: return over(number(std::numbers::log10e), u);
      case Operation::sin: return make(Operation::cos, u);
      case Operation::cos: return make(Operation::negate, make(Operation::sin, u));
      case Operation::tan: return plus(number(1.0), square(self));
      case Operation::asin: return over(number(1.0), root_of_one_minus_square(u));
      case Operation::acos: return over(number(-1.0), root_of_one_minus_square(u));
      case Operation::atan: return over(number(1.0), plus(number(1.0), square(u)));
      case Operation::sinh: return make(Operation::cosh, u);
      case Operation::cosh: return make(Operation::sinh, u);
      default: return minus(number(1.0), square(self));  // tanh
    }
  }

  // v u^(v - 1) du + u^v log(u) dv
  Term of_power(const Operand& u, const Operand& v, const Term& self) {
    const Term lower = make(Operation::power, u.value, minus(v.value, number(1.0)));
    const Term first = times(times(v.value, lower), u.derivative);
    if (algebra_.is_zero(v.derivative)) return first;
    return plus(first, times(times(self, make(Operation::log, u.value)), v.derivative));
  }

  Term root_of_one_minus_square(const Term& u) { return make(Operation::sqrt, minus(number(1.0), square(u))); }
  Term square(const Term& u) { return times(u, u); }

  Term number(double value) { return algebra_.number(value); }
  Term make(Operation operation, const Term& u) { return algebra_.make(operation, u); }
  Term make(Operation operation, const Term& u, const Term& v) { return algebra_.make(operation, u, v); }
  Term plus(const Term& u, const Term& v) { return make(Operation::add, u, v); }
  Term minus(const Term& u, const Term& v) { return make(Operation::subtract, u, v); }
  Term times(const Term& u, const Term& v) { return make(Operation::multiply, u, v); }
  Term over(const Term& u, const Term& v) { return make(Operation::divide, u, v); }

  Algebra& algebra_;
};

}  // namespace sfdae::cli
