// The differential part of one point, factored.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/differential_factors.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

void DifferentialFactors::resize(int n) {
  const std::size_t square = index(n) * index(n) + 1;
  R_.resize(square + index(n));
  row_space_.resize(square);
  kernel_.resize(square);
  pivots_.resize(index(n) + 1);
}

void DifferentialFactors::keep(ConstView factors, const int* pivots, const double* tau) {
  d_ = factors.cols;
  u_ = 0;
  has_reflections_ = true;
  std::copy_n(pivots, d_, pivots_.data());
  std::copy_n(tau, d_, this->tau());
  copy(factors, {R_.data(), d_, d_, std::max(d_, 1)});
}

void DifferentialFactors::factor(ConstView R3, const int* pivots, Arena& arena) {
  d_ = R3.rows;
  u_ = R3.cols - R3.rows;
  has_reflections_ = false;
  const int columns = R3.cols;
  std::copy_n(pivots, columns, pivots_.data());
  const View R{R_.data(), d_, d_, std::max(d_, 1)};
  if (u_ == 0) {
    copy(R3, R);
    return;
  }
  // R3^T = Q R, so that the row space of G is range Q1 and its kernel range Q2.
  const Arena::Frame frame(arena);
  const View rows = arena.matrix(columns, d_), Q = arena.matrix(columns, columns);
  for (int i = 0; i < d_; ++i)
    for (int j = 0; j < columns; ++j) rows(j, i) = j >= i ? R3(i, j) : 0.0;
  double* tau = arena.take(index(d_) + 1);
  factor_qr(rows, tau, arena);
  form_q(rows, d_, tau, Q, arena);
  copy(rows.top(d_), R);
  for (int i = 0; i < columns; ++i) {
    const int row = pivots[i];
    for (int j = 0; j < d_; ++j) row_space_[index(j * columns + row)] = Q(i, j);
    for (int j = 0; j < u_; ++j) kernel_[index(j * columns + row)] = Q(i, d_ + j);
  }
}

void DifferentialFactors::solve(const double* q, double* z, Arena& arena) const {
  const Arena::Frame frame(arena);
  double* y = arena.take(index(d_) + 1);
  std::copy_n(q, d_, y);
  const ConstView R{R_.data(), d_, d_, std::max(d_, 1)};
  if (u_ == 0) {
    if (has_reflections_) apply_q(Op::transposed, R, d_, tau(), {y, d_, 1, std::max(d_, 1)}, arena);
    solve_upper(Op::plain, R, {y, d_, 1, std::max(d_, 1)});
    for (int i = 0; i < d_; ++i) z[pivots_[index(i)]] = y[i];
    return;
  }
  solve_upper(Op::transposed, R, {y, d_, 1, std::max(d_, 1)});
  multiply(1.0, Op::plain, ConstView{row_space_.data(), unknowns(), d_, unknowns()}, y, 0.0, z);
}

double DifferentialFactors::smallest_kept() const {
  double smallest = d_ > 0 ? std::fabs(R_[0]) : 0.0;
  for (int i = 1; i < d_; ++i) smallest = std::min(smallest, std::fabs(R_[index(i) * index(d_ + 1)]));
  return smallest;
}

int DifferentialFactors::determinant_sign() const {
  int sign = permutation_sign(pivots_.data(), d_);
  if (has_reflections_) sign *= reflections_sign(tau(), d_);
  for (int i = 0; i < d_; ++i) {
    const double r = R_[index(i) * index(d_ + 1)];
    if (r == 0.0) return 0;
    if (r < 0.0) sign = -sign;
  }
  return sign;
}

}  // namespace sfdae::core
