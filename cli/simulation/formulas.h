// All expressions of a model as a graph of numbered formulas: equal formulas share a number, operands have smaller
// numbers than the formulas that use them, constants have been evaluated. Parameters are numbers in it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <unordered_map>
#include <utility>
#include <vector>

#include "model/operations.h"

namespace sfdae::cli {

using Formula = int;

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Quantities that the value of a formula depends on.
enum Dependence : unsigned {
  on_numbers = 0,
  on_continuous = 1,  // time, unknowns of type Real and their derivatives
  on_discrete = 2,    // quantities that change only at events
  on_free = 4,        // parameters that the initial equations determine
  on_derivative = 8   // derivatives of unknowns
};

// Operations are those of expressions, without no_event. A relation, floor or div with index >= 0 is frozen: it has the
// value of the switch of that number, and no operands.
struct FormulaNode {
  Operation operation = Operation::number;
  int index = -1;
  std::array<Formula, 3> operands{-1, -1, -1};
  double value = 0.0;
  unsigned dependence = on_numbers;

  bool operator==(const FormulaNode&) const = default;
};

class Formulas {
 public:
  // of_variable: dependence of each variable.
  explicit Formulas(std::vector<unsigned> of_variable) : of_variable_(std::move(of_variable)) {}

  Formula number(double value);
  Formula time();
  Formula variable(int index) { return leaf(Operation::variable, index, of_variable_[at(index)]); }
  Formula derivative(int index);
  Formula previous(int index) { return leaf(Operation::previous, index, on_discrete); }
  Formula flag(Operation operation, int index = -1) { return leaf(operation, index, on_discrete); }
  Formula frozen(Operation operation, int number_of_switch) { return leaf(operation, number_of_switch, on_discrete); }
  Formula apply(Operation operation, Formula a, Formula b = -1, Formula c = -1);

  Formula add(Formula a, Formula b) { return apply(Operation::add, a, b); }
  Formula subtract(Formula a, Formula b) { return apply(Operation::subtract, a, b); }
  Formula multiply(Formula a, Formula b) { return apply(Operation::multiply, a, b); }
  Formula negate(Formula a) { return apply(Operation::negate, a); }
  Formula both(Formula a, Formula b) { return apply(Operation::and_, a, b); }
  Formula either(Formula a, Formula b) { return apply(Operation::or_, a, b); }
  Formula inverse(Formula a) { return apply(Operation::not_, a); }

  const FormulaNode& operator[](Formula formula) const { return nodes_[at(formula)]; }
  int size() const { return static_cast<int>(nodes_.size()); }
  bool is_number(Formula formula) const { return nodes_[at(formula)].operation == Operation::number; }
  bool is_number(Formula formula, double value) const {
    return is_number(formula) && nodes_[at(formula)].value == value;
  }
  bool depends(Formula formula, unsigned on) const { return (nodes_[at(formula)].dependence & on) != 0; }

  // All formulas contained in these, in ascending order.
  std::vector<Formula> parts(const std::vector<Formula>& of) const;

  // Sets the flags of variables whose derivatives occur in these formulas.
  void mark_differentiated(const std::vector<Formula>& in, std::vector<char>& flags) const;

  int add_variable(unsigned dependence);  // its index

 private:
  struct Hash {
    std::size_t operator()(const FormulaNode& node) const;
  };

  Formula leaf(Operation operation, int index, unsigned dependence);
  Formula interned(const FormulaNode& node);
  Formula simplified(Operation operation, Formula a, Formula b, Formula c);  // -1: no simpler form
  Formula simplified_sum(Operation operation, Formula a, Formula b);
  Formula simplified_product(Operation operation, Formula a, Formula b);
  Formula simplified_logic(Operation operation, Formula a, Formula b, Formula c);

  std::vector<FormulaNode> nodes_;
  std::unordered_map<FormulaNode, Formula, Hash> known_;
  std::vector<unsigned> of_variable_;
  mutable std::vector<int> mark_;  // of parts()
  mutable int last_mark_ = 0;
};

// Substitutes formulas for variables.
class Substitution {
 public:
  explicit Substitution(Formulas& formulas) : formulas_(formulas) {}

  // derivative: -1 if der of it does not occur. Formulas that contain the variable must not have been substituted
  // before.
  void replace(int variable, Formula by, Formula derivative) { by_[variable] = {by, derivative}; }

  Formula operator()(Formula formula);

 private:
  Formula rebuilt(Formula formula);

  Formulas& formulas_;
  std::unordered_map<int, std::array<Formula, 2>> by_;
  std::unordered_map<Formula, Formula> known_;
};

}  // namespace sfdae::cli
