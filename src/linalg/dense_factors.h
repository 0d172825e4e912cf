// LU factors of a matrix with few zeros, by LAPACK.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "linalg/dense.h"
#include "linalg/determinant.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

// With all entries below 2, a smaller pivot counts as zero: 1e-150, so that quotients do not overflow.
constexpr double vanishing_pivot = 0x1p-500;

template <class Number>
class DenseFactors {
 public:
  void analyze(const SparsePattern& pattern) { size_ = pattern.size; }
  // False if a pivot vanishes.
  bool factor(const SparsePattern& pattern, const Number* values);
  static bool has_new_pivots() { return true; }
  void forget_pivots() {}
  // B := op(A)^-1 B, size x count
  void solve(Op op, Number* b, int count);
  std::size_t fill() const { return lu_.size(); }
  Determinant<Number> determinant() const;

 private:
  int size_ = 0;
  std::vector<Number> lu_;
  std::vector<int> pivots_;
};

}  // namespace sfdae::core
