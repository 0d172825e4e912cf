// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/band_factors.h"

#include <algorithm>
#include <limits>
#include <new>
#include <utility>

#include "linalg/dense_factors.h"
#include "linalg/lapack_names.h"

namespace sfdae::core {

template <class Number>
void BandFactors<Number>::analyze(const SparsePattern& pattern, BandOrder order) {
  size_ = pattern.size;
  order_ = std::move(order);
  const std::size_t ld = 2 * index(order_.lower) + index(order_.upper) + 1;
  // LAPACK counts in 32 bits.
  if (ld * index(size_) > index(std::numeric_limits<int>::max())) throw std::bad_alloc();
  ld_ = static_cast<int>(ld);
}

template <class Number>
bool BandFactors<Number>::factor(const SparsePattern& pattern, const Number* values) {
  const std::size_t ld = index(ld_);
  const int top = order_.lower + order_.upper;
  band_.assign(ld * index(size_), Number(0));
  pivots_.resize(index(size_));
  if (size_ == 0) return true;
  for (std::size_t j = 0; j < index(size_); ++j) {
    const int place = order_.column_place[j];
    Number* column = band_.data() + ld * index(place);
    for (int k = pattern.first[j]; k < pattern.first[j + 1]; ++k)
      column[top + order_.row_place[index(pattern.row[index(k)])] - place] = values[k];
  }
  int info = 0;
  lapack::gbtrf(&size_, &order_.lower, &order_.upper, band_.data(), &ld_, pivots_.data(), &info);
  if (info != 0) return false;
  for (std::size_t j = 0; j < index(size_); ++j)
    if (std::abs(band_[index(top) + ld * j]) < vanishing_pivot) return false;
  return true;
}

template <class Number>
void BandFactors<Number>::solve(Op op, Number* b, int count) {
  if (size_ == 0 || count == 0) return;
  const std::size_t n = index(size_);
  if (permuted_.size() < n * index(count)) permuted_.resize(n * index(count));
  const std::vector<int>& from = op == Op::plain ? order_.row_place : order_.column_place;
  const std::vector<int>& to = op == Op::plain ? order_.column_place : order_.row_place;
  for (std::size_t start = 0; start < n * index(count); start += n)
    for (std::size_t i = 0; i < n; ++i) permuted_[start + index(from[i])] = b[start + i];
  int info = 0;
  lapack::gbtrs(op == Op::plain ? "N" : "T", &size_, &order_.lower, &order_.upper, &count, band_.data(), &ld_,
                pivots_.data(), permuted_.data(), &size_, &info);
  for (std::size_t start = 0; start < n * index(count); start += n)
    for (std::size_t i = 0; i < n; ++i) b[start + i] = permuted_[start + index(to[i])];
}

template <class Number>
Determinant<Number> BandFactors<Number>::determinant() const {
  const std::size_t ld = index(ld_), top = index(order_.lower) + index(order_.upper);
  Determinant<Number> determinant;
  for (std::size_t j = 0; j < index(size_); ++j) {
    determinant.multiply(band_[top + ld * j]);
    determinant.change_sign_if(index(pivots_[j]) != j + 1);
  }
  determinant.change_sign_if(is_odd(order_.row_place.data(), size_) != is_odd(order_.column_place.data(), size_));
  return determinant;
}

template class BandFactors<double>;
template class BandFactors<std::complex<double>>;

}  // namespace sfdae::core
