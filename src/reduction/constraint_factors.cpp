// The constraints of one point, factored.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/constraint_factors.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

void ConstraintFactors::resize(int n, int rows) {
  factors_.resize(index(n) * index(rows) + 1);
  tau_.resize(index(n) + 1);
  pivots_.resize(index(rows) + 1);
  n_ = n;
}

void ConstraintFactors::factor(const Carried& carried, Judge& judge, Arena& arena) {
  factors_.resize(std::max(factors_.size(), index(n_) * index(carried.rows) + 1));
  pivots_.resize(std::max(pivots_.size(), index(carried.rows) + 1));
  rows_ = carried.rows;
  const View to{factors_.data(), n_, rows_, n_};
  for (int i = 0; i < rows_; ++i)
    for (int j = 0; j < n_; ++j) to(j, i) = carried.constraints(i, j);
  const Arena::Frame frame(arena);
  ConstView original;
  if (judge.keeps_originals()) {
    const View kept = arena.matrix(n_, rows_);
    copy(to, kept);
    original = kept;
  }
  factor_qr_pivoted(to, pivots_.data(), tau_.data(), arena);
  rank_ = rows_ > 0 ? judge.decide_constraints(to, original) : 0;
}

void ConstraintFactors::write_T2(View T2, Arena& arena) const {
  form_last_q(factors(), rank_, tau_.data(), T2, arena);
}

// A2 V = P R11^T.
int ConstraintFactors::orientation() const {
  int sign = permutation_sign(pivots_.data(), rank_) * reflections_sign(tau_.data(), rank_);
  for (int i = 0; i < rank_; ++i)
    if (factors()(i, i) < 0.0) sign = -sign;
  return sign;
}

// xp = Q [y; 0] with R11^T y = -f^, and the residual of the redundant rows: R12^T y + f^ = 0.
double ConstraintFactors::solve(const double* f_hat, double norm_f, double* xp, Arena& arena) const {
  const ConstView R = factors();
  std::fill_n(xp, n_, 0.0);
  // The carried part of f may consist of rounding errors of f.
  double scale = norm_f;
  for (int i = 0; i < rows_; ++i) scale = std::max(scale, std::fabs(f_hat[i]));
  for (int i = 0; i < rank_; ++i) xp[i] = -f_hat[pivots_[index(i)]];
  solve_upper(Op::transposed, R.block(0, 0, rank_, rank_), {xp, rank_, 1, n_});
  double worst = 0.0;
  for (int i = rank_; i < rows_; ++i) {
    double residual = f_hat[pivots_[index(i)]], size = scale;
    for (int k = 0; k < rank_; ++k) {
      residual += R(k, i) * xp[k];
      size = std::max(size, std::fabs(R(k, i) * xp[k]));
    }
    if (size > 0.0) worst = std::max(worst, std::fabs(residual) / size);
  }
  apply_q(Op::plain, R, rank_, tau_.data(), {xp, n_, 1, n_}, arena);
  return worst;
}

void ConstraintFactors::solve_transposed(const double* weights, double* weights_of_f, Arena& arena) const {
  const Arena::Frame frame(arena);
  double* along = arena.take(index(n_) + 1);
  std::copy_n(weights, n_, along);
  apply_q(Op::transposed, factors(), rank_, tau_.data(), {along, n_, 1, n_}, arena);
  solve_upper(Op::plain, factors().block(0, 0, rank_, rank_), {along, rank_, 1, n_});
  std::fill_n(weights_of_f, rows_, 0.0);
  for (int i = 0; i < rank_; ++i) weights_of_f[pivots_[index(i)]] = -along[i];
}

}  // namespace sfdae::core
