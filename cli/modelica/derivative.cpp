// Time derivatives of formulas by the chain rule.
// SPDX-License-Identifier: BSD-3-Clause
#include <unordered_map>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/symbols.h"

namespace sfdae::cli {

namespace {

class Differentiation {
 public:
  Differentiation(Elaboration& e, Location at) : e_(e), at_(at) {}

  Expression of(const Expression& x) {
    if (const auto found = known_.find(x.get()); found != known_.end()) return found->second;
    e_.charge(1, at_);
    Expression result = x->operands.empty() ? of_leaf(x) : of_operation(x);
    known_.emplace(x.get(), result);
    return result;
  }

 private:
  Expression number(double value) { return e_.pool.number(value, at_); }
  Expression make(Operation operation, Expression a) { return e_.pool.make(operation, {std::move(a)}, at_); }
  Expression make(Operation operation, Expression a, Expression b) {
    return e_.pool.make(operation, {std::move(a), std::move(b)}, at_);
  }
  Expression square(const Expression& x) { return make(Operation::multiply, x, x); }

  Expression of_leaf(const Expression& x) {
    switch (x->operation) {
      case Operation::time: return number(1.0);
      case Operation::variable: return e_.symbols->derivative_of_variable(x->index, at_);
      case Operation::derivative: return e_.symbols->second_derivative(x->index, at_);
      default: return number(0.0);
    }
  }

  Expression of_operation(const Expression& x) {
    const std::vector<Expression>& u = x->operands;
    switch (x->operation) {
      case Operation::choose: {
        const Expression first = of(u[1]), second = of(u[2]);
        return e_.pool.make(Operation::choose, {u[0], first, second}, at_);
      }
      case Operation::no_event: return make(Operation::no_event, of(u[0]));
      default: break;
    }
    if (u.size() == 1) {
      const Expression du = of(u[0]);
      return is_number(du, 0.0) ? du : make(Operation::multiply, outer(x), du);
    }
    return u.size() == 2 ? of_two(x->operation, u[0], u[1]) : number(0.0);
  }

  // The derivative with respect to the only operand.
  Expression outer(const Expression& x) {
    const Expression& u = x->operands[0];
    switch (x->operation) {
      case Operation::negate: return number(-1.0);
      case Operation::abs: return make(Operation::sign, u);
      case Operation::sqrt: return make(Operation::divide, number(0.5), x);
      case Operation::exp: return x;
      case Operation::log: return make(Operation::divide, number(1.0), u);
      case Operation::log10: return make(Operation::divide, number(0.43429448190325182765), u);  // log10(e)
      case Operation::sin: return make(Operation::cos, u);
      case Operation::cos: return make(Operation::negate, make(Operation::sin, u));
      case Operation::tan: return make(Operation::add, number(1.0), square(x));
      case Operation::asin: return make(Operation::divide, number(1.0), root_of_one_minus_square(u));
      case Operation::acos: return make(Operation::divide, number(-1.0), root_of_one_minus_square(u));
      case Operation::atan: return make(Operation::divide, number(1.0), make(Operation::add, number(1.0), square(u)));
      case Operation::sinh: return make(Operation::cosh, u);
      case Operation::cosh: return make(Operation::sinh, u);
      case Operation::tanh: return make(Operation::subtract, number(1.0), square(x));
      default: return number(0.0);  // sign, floor, ...: constant between their jumps
    }
  }

  Expression root_of_one_minus_square(const Expression& u) {
    return make(Operation::sqrt, make(Operation::subtract, number(1.0), square(u)));
  }

  Expression of_two(Operation operation, const Expression& u, const Expression& v) {
    switch (operation) {
      case Operation::add:
      case Operation::subtract: return make(operation, of(u), of(v));
      case Operation::multiply:
        return make(Operation::add, make(Operation::multiply, of(u), v), make(Operation::multiply, u, of(v)));
      case Operation::divide:  // du / v - u dv / v^2
        return make(Operation::subtract, make(Operation::divide, of(u), v),
                    make(Operation::divide, make(Operation::multiply, u, of(v)), square(v)));
      case Operation::power: return of_power(u, v);
      case Operation::atan2: {
        const Expression above =
            make(Operation::subtract, make(Operation::multiply, of(u), v), make(Operation::multiply, u, of(v)));
        return make(Operation::divide, above, make(Operation::add, square(u), square(v)));
      }
      case Operation::min:
      case Operation::max: {
        const Expression first = make(operation == Operation::min ? Operation::less : Operation::greater, u, v);
        return e_.pool.make(Operation::choose, {make(Operation::no_event, first), of(u), of(v)}, at_);
      }
      case Operation::mod: return of_remainder(Operation::floor, u, v);
      case Operation::rem:
        return make(Operation::subtract, of(u), make(Operation::multiply, make(Operation::div, u, v), of(v)));
      default: return number(0.0);  // relations, div: constant between their jumps
    }
  }

  // u - round(u / v) v
  Expression of_remainder(Operation round, const Expression& u, const Expression& v) {
    const Expression quotient = make(round, make(Operation::divide, u, v));
    return make(Operation::subtract, of(u), make(Operation::multiply, quotient, of(v)));
  }

  Expression of_power(const Expression& u, const Expression& v) {
    const Expression du = of(u), dv = of(v);
    const Expression lower = make(Operation::power, u, make(Operation::subtract, v, number(1.0)));
    const Expression first = make(Operation::multiply, make(Operation::multiply, v, lower), du);
    if (is_number(dv, 0.0)) return first;
    const Expression x = make(Operation::power, u, v);
    return make(Operation::add, first,
                make(Operation::multiply, make(Operation::multiply, x, make(Operation::log, u)), dv));
  }

  Elaboration& e_;
  Location at_;
  std::unordered_map<const Node*, Expression> known_;
};

}  // namespace

Expression derivative(Elaboration& e, const Expression& expression, Location at) {
  if (expression == nullptr) e.fail(at, "der of a value that has not been assigned");
  return Differentiation(e, at).of(expression);
}

}  // namespace sfdae::cli
