// Residuals of a system as expressions of the library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "simulation/tape.h"

#include <sfdae/sfdae.hpp>

namespace sfdae::cli {

// A discrete formula that is not recorded with its operands.
struct DiscreteLeaf {
  double value = 0.0;
  std::string name;  // the name of the parameter; empty: a number in this mode
};

// Records residuals for fixed values of all discrete quantities that are not parameters. Branches that are not taken
// are not recorded.
class Recording {
 public:
  Recording(const System& system, const Values& values, const std::unordered_map<Formula, DiscreteLeaf>& leaves);

  // unknown_of: by variable of the model, its number among x, -1 for none.
  void record(const std::vector<int>& unknown_of, const sfdae::Expression& t, sfdae::ConstExpressions x,
              sfdae::ConstExpressions xdot, sfdae::Expressions residuals);

 private:
  void find_numbers(const std::vector<Formula>& parts);
  std::vector<Formula> needed() const;
  sfdae::Expression operation(const FormulaNode& node) const;
  const sfdae::Expression& operand(const FormulaNode& node, std::size_t k) const {
    return recorded_.at(node.operands[k]);
  }

  const System& system_;
  const Values& values_;
  const std::unordered_map<Formula, DiscreteLeaf>& leaves_;
  std::unordered_map<Formula, double> numbers_;  // formulas that are numbers in this mode
  std::unordered_map<Formula, sfdae::Expression> recorded_;
};

}  // namespace sfdae::cli
