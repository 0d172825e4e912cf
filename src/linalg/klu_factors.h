// LU factors of a sparse matrix by KLU, in builds with it (SFDAE_WITH_KLU).
//
// [DP10] T. A. Davis, E. Palamadai Natarajan: Algorithm 907: KLU, a direct sparse solver for circuit simulation
// problems.
//        ACM Trans. Math. Software 37 (2010), 36.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <memory>

#include "linalg/dense.h"
#include "linalg/determinant.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

// False: the functions of KluFactors throw std::logic_error.
bool klu_is_available();

template <class Number>
class KluFactors {
 public:
  KluFactors();
  ~KluFactors();
  KluFactors(const KluFactors& other);
  KluFactors(KluFactors&& other) noexcept;
  KluFactors& operator=(KluFactors other) noexcept;

  void analyze(const SparsePattern& pattern);
  // Estimated by analyze(), of a factorization; 0 if not known.
  double flops() const;
  // The pivots of the previous factorization are reused if they are good enough. False if one vanishes.
  bool factor(const SparsePattern& pattern, const Number* values);
  // The last factorization has chosen its pivots.
  bool has_new_pivots() const { return has_new_pivots_; }
  void forget_pivots();
  // B := op(A)^-1 B, size x count
  void solve(Op op, Number* b, int count);
  std::size_t fill() const;
  Determinant<Number> determinant() const;

 private:
  struct State;
  std::unique_ptr<State> state_;  // nullptr until analyze()
  bool has_new_pivots_ = false;
};

}  // namespace sfdae::core
