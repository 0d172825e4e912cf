// Structural test that rules out singular points of recorded equations.
//
// If the system Jacobian is nonsingular at a consistent point, solutions through it are unique and smooth, with sum d -
// sum c free values [P01]: nothing has vanished, however small a kept value of E T2 or A2 has become in the units of
// the unknowns (docs/design/singular_points.md).
//
// [P01] J. D. Pryce: A Simple Structural Analysis Method for DAEs. BIT 41 (2001), 364-394.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "array/analyzed_equations.h"
#include "structure/block_determinants.h"
#include "structure/structure.h"
#include "structure/system_jacobian.h"
#include "system/jet.h"

namespace sfdae::core {

class StructuralWitness {
 public:
  // Available only for formulas without prescribed components, if the structural analysis is confirmed numerically at
  // this consistent jet and gives the known number of free values.
  StructuralWitness(const AnalyzedEquations& equations, const Jet& jet);

  bool speaks() const { return determinants_ != nullptr; }
  // The system Jacobian is nonsingular wherever the equations can be evaluated: its blocks do not vary.
  bool is_always_regular() const { return speaks() && determinants_->count() == 0; }
  // It is nonsingular at a consistent jet if it is at `before` and `after`: no determinant changes its sign or falls.
  bool is_regular_at(const Jet& jet, const Jet& before, const Jet& after);
  // No determinant has another sign at a consistent jet than at `before` and `after`, however small it has become.
  bool keeps_signs(const Jet& jet, const Jet& before, const Jet& after);

 private:
  bool measure(const Jet& jet, const Jet& before, const Jet& after);
  bool is_confirmed_at(const AnalyzedEquations& equations, const Jet& jet);

  const Structure* structure_ = nullptr;  // of the problem
  std::unique_ptr<SystemJacobian> jacobian_;
  std::unique_ptr<BlockDeterminants> determinants_;  // null: no test is available
  std::vector<BlockDeterminants::Value> here_, before_, after_;
};

}  // namespace sfdae::core
