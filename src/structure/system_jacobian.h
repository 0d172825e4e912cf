// The system Jacobian J_ij = d f_i / d x_j^(d_j - c_i) where equation i contains that derivative, else 0 [P01];
// sparse, by rows.
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

  // Of the jets wanted; 1 unless equations were replaced.
  int jet_order() const { return order_ + 1; }
  // False: the equations cannot be evaluated there. jet: of jet_order(), at least.
  bool evaluate(TaylorEvaluator& evaluator, double t, const double* jet);

  // Entries that do not depend on the point are not evaluated again before parameters change, nor are derivatives
  // that are no entries: worth a list of its own where points are many. The evaluator is the same one from now on.
  void expect_many_points();

  // Until they are evaluated the next time, there are no values, and there is no memory for them.
  void forget_values();

  // Entries that differ from these by more than a part of them become zero.
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
  std::vector<EntryTerm> terms_;       // none where each entry is one coefficient,
  std::vector<std::uint32_t> places_;  // and where that is
  std::size_t num_coefficients_ = 0;
  std::vector<double> coefficients_, values_;
  std::optional<VaryingEntries> varying_;  // where many points are expected
};

// Entries of the diagonal blocks.
class BlockEntries {
 public:
  // Both live longer.
  BlockEntries(const Structure& structure, const SystemJacobian& jacobian)
      : structure_(structure), jacobian_(jacobian), place_(index(structure.signature.size()), -1) {}

  // action(row, column, entry), row after row: in the block, entry: of the values of the system Jacobian.
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
