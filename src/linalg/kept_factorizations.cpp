// Stored pivoted QR factorizations that are requested again.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/kept_factorizations.h"

#include <algorithm>
#include <cstring>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Bitwise comparison: zeros of different sign make different matrices.
bool is_same(ConstView a, ConstView b) {
  if (a.rows != b.rows || a.cols != b.cols) return false;
  for (int j = 0; j < a.cols; ++j)
    if (std::memcmp(a.column(j), b.column(j), index(a.rows) * sizeof(double)) != 0) return false;
  return true;
}

bool has_size_of(ConstView a, ConstView b) { return a.data != nullptr && a.rows == b.rows && a.cols == b.cols; }

}  // namespace

void KeptFactorizations::Factorization::copy_to(View a, int* to_pivots, double* to_tau) const {
  copy(factors, a);
  std::copy_n(pivots, a.cols, to_pivots);
  std::copy_n(tau, std::min(a.rows, a.cols), to_tau);
}

// If the factorization is not stored, last_ becomes the place of the oldest.
bool KeptFactorizations::find(ConstView A, double negligible) {
  for (last_ = 0; last_ < kept_.size(); ++last_)
    if (kept_[last_].negligible == negligible && is_same(kept_[last_].original, A)) return true;
  last_ = next_;
  next_ = (next_ + 1) % kept_.size();
  return false;
}

void KeptFactorizations::factor(ConstView A, double negligible, View a, int* pivots, double* tau, Arena& scratch) {
  const bool is_kept = find(A, negligible);
  Factorization& of_A = kept_[last_];
  if (is_kept) return of_A.copy_to(a, pivots, tau);
  const int reflections = std::min(A.rows, A.cols);
  copy(A, a);
  factor_qr_pivoted(a, pivots, tau, scratch, negligible);
  if (!has_size_of(of_A.original, A))
    of_A = {memory_->matrix(A.rows, A.cols),
            memory_->matrix(A.rows, A.cols),
            {},
            memory_->integers(A.cols),
            memory_->take(index(reflections))};
  copy(A, of_A.original);
  copy(a, of_A.factors);
  std::copy_n(pivots, A.cols, of_A.pivots);
  std::copy_n(tau, reflections, of_A.tau);
  of_A.negligible = negligible;
  of_A.reflections_of_q = -1;
}

// A factorization that ended earlier than another one would has the same reflections up to its end.
bool KeptFactorizations::find_first(ConstView A, int count, View a, int* pivots, double* tau) const {
  for (const Factorization& kept : kept_) {
    if (!is_same(kept.original, A) || (count > 0 && kept.tau[count - 1] == 0.0)) continue;
    kept.copy_to(a, pivots, tau);
    return true;
  }
  return false;
}

void KeptFactorizations::form_q(ConstView factors, int count, const double* tau, View q, Arena& scratch) {
  Factorization& last = kept_[last_];
  if (last.reflections_of_q == count && has_size_of(last.q, q)) return copy(last.q, q);
  core::form_q(factors, count, tau, q, scratch);
  if (!has_size_of(last.q, q)) last.q = memory_->matrix(q.rows, q.cols);
  copy(q, last.q);
  last.reflections_of_q = count;
}

}  // namespace sfdae::core
