// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/linear_form.h"

#include <cmath>

namespace sfdae::cli {

namespace {

// Limit of terms: sums of shared sums have more terms than formulas, and long ones are of no use.
constexpr std::size_t max_terms = 2000;

}  // namespace

LinearForm linear_form(const Formulas& formulas, Formula formula) {
  LinearForm result;
  std::vector<std::pair<double, Formula>> stack{{1.0, formula}};
  for (std::size_t count = 0; !stack.empty(); ++count) {
    if (count > max_terms) {
      result.is_whole = false;
      return result;
    }
    const auto [factor, f] = stack.back();
    stack.pop_back();
    const FormulaNode& node = formulas[f];
    const auto [a, b, c] = node.operands;
    switch (node.operation) {
      case Operation::number: result.constant += factor * node.value; break;
      case Operation::variable:
        if ((node.dependence & on_continuous) != 0) result.coefficients[node.index] += factor;
        else result.others.emplace_back(factor, f);
        break;
      case Operation::negate: stack.emplace_back(-factor, a); break;
      case Operation::add:
      case Operation::subtract:
        stack.emplace_back(node.operation == Operation::add ? factor : -factor, b);
        stack.emplace_back(factor, a);
        break;
      case Operation::multiply:
        if (formulas.is_number(a)) stack.emplace_back(factor * formulas[a].value, b);
        else if (formulas.is_number(b)) stack.emplace_back(factor * formulas[b].value, a);
        else result.others.emplace_back(factor, f);
        break;
      case Operation::divide:
        if (formulas.is_number(b) && formulas[b].value != 0.0) stack.emplace_back(factor / formulas[b].value, a);
        else result.others.emplace_back(factor, f);
        break;
      default: result.others.emplace_back(factor, f);
    }
  }
  return result;
}

// Coefficients 1 and -1 need no division.
Formula solved(Formulas& formulas, const LinearForm& form, double coefficient) {
  const bool is_unit = std::fabs(coefficient) == 1.0;
  const double scale = is_unit ? -coefficient : 1.0;
  Formula sum = formulas.number(0.0);
  const auto add = [&](double factor, Formula term) {
    if (factor == 1.0) sum = formulas.add(sum, term);
    else if (factor == -1.0) sum = formulas.subtract(sum, term);
    else sum = formulas.add(sum, formulas.multiply(formulas.number(factor), term));
  };
  for (const auto& [variable, factor] : form.coefficients)
    if (factor != 0.0) add(factor * scale, formulas.variable(variable));
  for (const auto& [factor, term] : form.others) add(factor * scale, term);
  sum = formulas.add(sum, formulas.number(form.constant * scale));
  return is_unit ? sum : formulas.apply(Operation::divide, sum, formulas.number(-coefficient));
}

}  // namespace sfdae::cli
