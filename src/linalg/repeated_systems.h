// Sparse systems of linear equations of one pattern, one after another: by a list of operations while it is suitable,
// else with sparse factors that reuse the pivots of an earlier matrix.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "linalg/archive.h"
#include "linalg/known_pivots.h"
#include "linalg/matrix.h"
#include "linalg/planned_lu.h"
#include "linalg/sparse_lu.h"

namespace sfdae::core {

class RepeatedSystems {
 public:
  // Forgets the pivots. accepted: see PlannedLu.
  void analyze(const SparsePattern& pattern, double accepted = rounding_of_residuals) {
    pattern_ = pattern;
    planned_.analyze(pattern_, accepted);
    pivots_.forget();
    has_lu_ = false;
  }
  int size() const { return pattern_.size; }
  std::size_t num_entries() const { return pattern_.row.size(); }

  // X := A^-1 B, both column-major, size x count, without overlap; values in the order of the pattern. False: A is
  // singular to working precision, or a value is not finite.
  bool solve(const std::vector<double>& values, const double* b, int count, double* x) {
    if (planned_.is_suitable() && planned_.solve(values.data(), b, count, x)) return true;
    if (!has_lu_) lu_.analyze(pattern_);
    has_lu_ = true;
    if (!pivots_.factor(lu_, values)) return false;
    const std::size_t length = index(size()) * index(count);
    std::copy_n(b, length, x);
    lu_.solve(x, count);
    return all_finite(x, length);
  }

  // Reading: after analyze() of the same pattern. Throws DamagedArchive.
  void archive(Archive& archive) {
    bool has_lu = has_lu_;
    archive.small(has_lu);
    planned_.archive(archive);
    if (!has_lu) return;
    if (archive.is_reading()) lu_.analyze(pattern_);
    has_lu_ = true;
    pivots_.archive(archive, lu_, num_entries());
  }

 private:
  SparsePattern pattern_;
  PlannedLu planned_;
  SparseLu<double> lu_;  // if the list is unsuitable
  bool has_lu_ = false;
  KnownPivots pivots_;  // of lu_
};

}  // namespace sfdae::core
