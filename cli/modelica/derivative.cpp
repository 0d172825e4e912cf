// Time derivatives of formulas by the chain rule.
// SPDX-License-Identifier: BSD-3-Clause
#include <unordered_map>
#include <utility>

#include "model/chain_rule.h"
#include "modelica/arithmetic.h"
#include "modelica/symbols.h"

namespace sfdae::cli {

namespace {

// Constructs expressions for the chain rule.
struct Expressions {
  using Term = Expression;

  Expression number(double value) { return pool.number(value, at); }
  Expression make(Operation operation, const Expression& u) { return pool.make(operation, {u}, at); }
  Expression make(Operation operation, const Expression& u, const Expression& v) {
    return pool.make(operation, {u, v}, at);
  }
  Expression choose(Operation relation, const Expression& u, const Expression& v, const Expression& a,
                    const Expression& b) {
    return pool.make(Operation::choose, {make(Operation::no_event, make(relation, u, v)), a, b}, at);
  }
  bool is_zero(const Expression& u) const { return is_number(u, 0.0); }

  ExpressionPool& pool;
  Location at;
};

class Differentiation {
 public:
  Differentiation(Elaboration& e, Location at) : e_(e), at_(at), expressions_{e.pool, at} {}

  Expression of(const Expression& x) {
    if (const auto found = known_.find(x.get()); found != known_.end()) return found->second;
    e_.charge(1, at_);
    Expression result = x->operands.empty() ? of_leaf(x) : of_operation(x);
    known_.emplace(x.get(), result);
    return result;
  }

 private:
  Expression of_leaf(const Expression& x) {
    switch (x->operation) {
      case Operation::time: return expressions_.number(1.0);
      case Operation::variable: return e_.symbols->derivative_of_variable(x->index, at_);
      case Operation::derivative: return e_.symbols->second_derivative(x->index, at_);
      default: return expressions_.number(0.0);
    }
  }

  Expression of_operation(const Expression& x) {
    const std::vector<Expression>& u = x->operands;
    if (is_stepwise(x->operation)) return expressions_.number(0.0);
    if (x->operation == Operation::no_event) return expressions_.make(Operation::no_event, of(u[0]));
    if (x->operation == Operation::choose) {
      const Expression first = of(u[1]), second = of(u[2]);
      return e_.pool.make(Operation::choose, {u[0], first, second}, at_);
    }
    const Expression du = of(u[0]);
    ChainRule<Expressions> rule(expressions_);
    if (u.size() == 1) return rule.of_one(x->operation, {u[0], du}, x);
    return rule.of_two(x->operation, {u[0], du}, {u[1], of(u[1])}, x);
  }

  Elaboration& e_;
  Location at_;
  Expressions expressions_;
  std::unordered_map<const Node*, Expression> known_;
};

}  // namespace

Expression derivative(Elaboration& e, const Expression& expression, Location at) {
  if (expression == nullptr) e.fail(at, "der of a value that has not been assigned");
  return Differentiation(e, at).of(expression);
}

}  // namespace sfdae::cli
