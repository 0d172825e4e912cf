// A diagonal matrix in place of its factors, such as the derivatives of an explicit system by x'.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "linalg/dense.h"
#include "linalg/determinant.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

inline bool is_diagonal(const SparsePattern& pattern) {
  if (pattern.row.size() != index(pattern.size)) return false;
  for (int j = 0; j < pattern.size; ++j)
    if (pattern.first[index(j)] != j || pattern.row[index(j)] != j) return false;
  return true;
}

// Same interface as the other factors of SparseLu; no entry is zero.
template <class Number>
class DiagonalFactors {
 public:
  bool factor(const SparsePattern&, const Number* values) {
    has_new_pivots_ = pivots_.empty();
    pivots_.assign(values, values + size_);
    return true;
  }
  void analyze(const SparsePattern& pattern) { size_ = index(pattern.size); }
  bool has_new_pivots() const { return has_new_pivots_; }
  void forget_pivots() { pivots_.clear(); }
  void solve(Op, Number* b, int count) const {
    for (int c = 0; c < count; ++c, b += size_)
      for (std::size_t i = 0; i < size_; ++i) b[i] /= pivots_[i];
  }
  // Entries of the lower factor count, too, as for the other methods.
  std::size_t fill() const { return 2 * size_; }
  Determinant<Number> determinant() const {
    Determinant<Number> determinant;
    for (const Number& pivot : pivots_) determinant.multiply(pivot);
    return determinant;
  }

 private:
  std::size_t size_ = 0;
  bool has_new_pivots_ = false;
  std::vector<Number> pivots_;
};

}  // namespace sfdae::core
