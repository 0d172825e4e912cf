// LU factors of a sparse matrix whose rows and columns are permuted to a band, by LAPACK.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "linalg/band_order.h"
#include "linalg/dense.h"
#include "linalg/determinant.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

template <class Number>
class BandFactors {
 public:
  void analyze(const SparsePattern& pattern, BandOrder order);
  // False if a pivot vanishes.
  bool factor(const SparsePattern& pattern, const Number* values);
  static bool has_new_pivots() { return true; }
  void forget_pivots() {}
  // B := op(A)^-1 B, size x count
  void solve(Op op, Number* b, int count);
  std::size_t fill() const { return index(size_) * (2 * index(order_.lower) + index(order_.upper) + 1); }
  Determinant<Number> determinant() const;

 private:
  int size_ = 0;
  int ld_ = 1;
  BandOrder order_;
  std::vector<Number> band_;  // entry (i, j) of the permuted matrix at lower + upper + i - j + j ld
  std::vector<int> pivots_;
  std::vector<Number> permuted_;  // right-hand sides
};

}  // namespace sfdae::core
