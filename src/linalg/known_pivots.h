// Sparse factors with the matrix that their pivots were chosen for, so that the factors can be archived.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/archive.h"
#include "linalg/sparse_lu.h"

namespace sfdae::core {

class KnownPivots {
 public:
  // Call after analyze() of the factors: no pivots are known.
  void forget() { values_.clear(); }
  // Same result as SparseLu::factor. After a failure the factors have no pivots.
  bool factor(SparseLu<double>& lu, const std::vector<double>& values) {
    if (!lu.factor(values.data())) {
      lu.forget_pivots();
      forget();
      return false;
    }
    if (lu.method() == SparseMethod::klu && lu.has_new_pivots()) values_ = values;
    return true;
  }
  // entries: of the matrix. Reading restores the pivots of the factors. Throws DamagedArchive.
  void archive(Archive& archive, SparseLu<double>& lu, std::size_t entries) {
    bool are_known = !values_.empty();
    archive.small(are_known);
    if (!are_known) return;
    archive.reals(values_, entries);
    if (!archive.is_reading()) return;
    if (lu.method() != SparseMethod::klu || !lu.factor(values_.data())) throw DamagedArchive();
  }

 private:
  std::vector<double> values_;
};

}  // namespace sfdae::core
