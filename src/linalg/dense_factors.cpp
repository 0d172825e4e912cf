// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/dense_factors.h"

#include <algorithm>
#include <limits>
#include <new>

#include "linalg/equilibration.h"
#include "linalg/lapack_names.h"

namespace sfdae::core {

template <class Number>
bool DenseFactors<Number>::factor(const SparsePattern& pattern, const Number* values) {
  const std::size_t n = index(size_);
  // LAPACK counts in 32 bits.
  if (n * n > index(std::numeric_limits<int>::max())) throw std::bad_alloc();
  lu_.assign(n * n, Number(0));
  pivots_.resize(n);
  if (n == 0) return true;
  for (std::size_t j = 0; j < n; ++j)
    for (int k = pattern.first[j]; k < pattern.first[j + 1]; ++k)
      lu_[index(pattern.row[index(k)]) + n * j] = values[k];
  int info = 0;
  lapack::getrf(&size_, &size_, lu_.data(), &size_, pivots_.data(), &info);
  if (info != 0) return false;
  for (std::size_t j = 0; j < n; ++j)
    if (std::abs(lu_[j + n * j]) < vanishing_pivot) return false;
  return true;
}

template <class Number>
void DenseFactors<Number>::solve(Op op, Number* b, int count) {
  if (size_ == 0 || count == 0) return;
  int info = 0;
  lapack::getrs(op == Op::plain ? "N" : "T", &size_, &count, lu_.data(), &size_, pivots_.data(), b, &size_, &info);
}

template <class Number>
Determinant<Number> DenseFactors<Number>::determinant() const {
  Determinant<Number> determinant;
  for (std::size_t j = 0; j < index(size_); ++j) {
    determinant.multiply(lu_[j + index(size_) * j]);
    determinant.change_sign_if(index(pivots_[j]) != j + 1);
  }
  return determinant;
}

template class DenseFactors<double>;
template class DenseFactors<std::complex<double>>;

}  // namespace sfdae::core
