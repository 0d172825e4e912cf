// The system Jacobian [P01], sparse, by rows: J_ij = d f_i / d x_j^(d_j - c_i) if equation i contains that derivative,
// else 0.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "structure/structure.h"

namespace sfdae::core {

class SystemJacobian {
 public:
  SystemJacobian(const Structure& structure, const Tape& tape);

  // Order of the jets required; 1 unless equations were replaced.
  int jet_order() const { return order_ + 1; }
  // False if the equations cannot be evaluated there. jet: of jet_order(), at least.
  bool evaluate(TaylorEvaluator& evaluator, double t, const double* jet);

  // Until parameters change, constant entries, and derivatives that are not entries, are not evaluated again: this is
  // worth a list of its own if there are many points. The evaluator has to be the same one from now on.
  void expect_many_points();

  // Frees the memory of the values until they are evaluated again.
  void forget_values();

  // Sets entries to zero that differ from these by more than a fraction.
  void drop_changes_from(const std::vector<double>& values);

  // The entries of equation i are first()[i], ..., first()[i + 1] - 1.
  const std::vector<int>& first() const { return first_; }
  const std::vector<int>& unknown() const { return unknown_; }
  const std::vector<double>& values() const { return values_; }

 private:
  void note_places();

  int order_;
  std::vector<int> first_{0}, unknown_;
  std::vector<int> limits_;            // of the coefficients of each recorded equation
  std::vector<EntryTerm> terms_;       // empty if each entry is one coefficient,
  std::vector<std::uint32_t> places_;  // and where that is
  std::size_t num_coefficients_ = 0;
  std::vector<double> coefficients_, values_;
  std::optional<VaryingEntries> varying_;  // if many points are expected
};

// Entries of the diagonal blocks.
class BlockEntries {
 public:
  // Both have to outlive this object.
  BlockEntries(const Structure& structure, const SystemJacobian& jacobian)
      : structure_(structure), jacobian_(jacobian), place_(index(structure.signature.size()), -1) {}

  // action(row, column, entry), row after row: row and column in the block, entry of the system Jacobian.
  template <class Action>
  void for_each(int block, Action action) {
    const auto equations = structure_.blocks.equations(block), unknowns = structure_.blocks.unknowns(block);
    for (std::size_t k = 0; k < unknowns.size(); ++k) place_[index(unknowns[k])] = static_cast<int>(k);
    for (std::size_t row = 0; row < equations.size(); ++row) {
      const std::size_t i = index(equations[row]);
      for (int e = jacobian_.first()[i]; e < jacobian_.first()[i + 1]; ++e)
        if (const int column = place_[index(jacobian_.unknown()[index(e)])]; column >= 0)
          action(static_cast<int>(row), column, e);
    }
    for (int j : unknowns) place_[index(j)] = -1;
  }

 private:
  const Structure& structure_;
  const SystemJacobian& jacobian_;
  std::vector<int> place_;  // of unknowns in the block at hand
};

}  // namespace sfdae::core
