// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/time_derivative.h"

#include <cassert>

#include "model/chain_rule.h"

namespace sfdae::cli {

namespace {

// Constructs formulas for the chain rule.
struct Terms {
  using Term = Formula;

  Formula number(double value) { return formulas.number(value); }
  Formula make(Operation operation, Formula u) { return formulas.apply(operation, u); }
  Formula make(Operation operation, Formula u, Formula v) { return formulas.apply(operation, u, v); }
  Formula choose(Operation relation, Formula u, Formula v, Formula a, Formula b) {
    return formulas.apply(Operation::choose, formulas.apply(relation, u, v), a, b);
  }
  bool is_zero(Formula u) const { return formulas.is_number(u, 0.0); }

  Formulas& formulas;
};

}  // namespace

// Operands have smaller numbers than the formulas that use them, so they come first.
Formula TimeDerivative::operator()(Formula formula) {
  for (Formula part : formulas_.parts({formula}))
    if (known_.count(part) == 0) known_[part] = of_part(part);
  return known_.at(formula);
}

Formula TimeDerivative::of_part(Formula formula) {
  const FormulaNode node = formulas_[formula];
  assert(node.operation != Operation::derivative);
  if ((node.dependence & on_continuous) == 0) return formulas_.number(0.0);
  const auto [u, v, w] = node.operands;
  Terms terms{formulas_};
  ChainRule<Terms> rule(terms);
  switch (node.operation) {
    case Operation::time: return formulas_.number(1.0);
    case Operation::variable: return of_variable_(node.index);
    case Operation::choose: return formulas_.apply(Operation::choose, u, known_.at(v), known_.at(w));
    default: break;
  }
  if (num_operands(node.operation) == 1) return rule.of_one(node.operation, {u, known_.at(u)}, formula);
  return rule.of_two(node.operation, {u, known_.at(u)}, {v, known_.at(v)}, formula);
}

}  // namespace sfdae::cli
