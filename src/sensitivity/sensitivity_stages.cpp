// The stages of an implicit Runge-Kutta step of sensitivities.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/sensitivity_stages.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

void SensitivityStages::resize(int s, int n, int d, int count) {
  if (s == s_ && n == n_ && d == d_ && count == count_) return;
  s_ = 0;  // while memory may be missing
  Stage stage;
  stage.xp = Matrix(n, count);
  stage.L = Matrix(d, n);
  stage.B = Matrix(d, d);
  stage.b = Matrix(d, count);
  stages_.assign(index(s), stage);
  T2_ = Matrix(n, s * d);
  matrix_ = Matrix(padded_rows(s * d), s * d);
  z_ = Matrix(s * d, count);
  pivots_.assign(index(s * d) + 1, 0);
  s_ = s;
  n_ = n;
  d_ = d;
  count_ = count;
}

void SensitivityStages::keep_matrices(int i, const LinearizedPoint& point) {
  Stage& stage = stages_[index(i)];
  is_ordinary_ = point.is_ordinary();
  copy(point.ZE(), stage.L);
  if (is_ordinary_) {
    copy(point.ZA(), stage.B);
  } else {
    copy(point.T2(), T2_.view().block(0, i * d_, n_, d_));
    multiply(1.0, Op::plain, point.ZA(), Op::plain, point.T2(), 0.0, stage.B);
  }
  stage.tau = point.time_scale();
}

void SensitivityStages::keep(int i, const SensitivityPoint& point) {
  keep_matrices(i, point);
  Stage& stage = stages_[index(i)];
  copy(point.Zf(), stage.b);
  if (is_ordinary_) return;
  copy(point.xp(), stage.xp);
  multiply(1.0, Op::plain, point.ZA(), Op::plain, point.xp(), 1.0, stage.b);
}

SensitivityStages::Parts SensitivityStages::parts(int i, double time_scale) {
  Stage& stage = stages_[index(i)];
  is_ordinary_ = false;
  stage.tau = time_scale;
  return {stage.xp, T2_.view().block(0, i * d_, n_, d_), stage.L, stage.B, stage.b};
}

bool SensitivityStages::factor(const StageMethod& method, double h, Arena& arena) {
  const View M = matrix_.view().top(s_ * d_);
  const Arena::Frame frame(arena);
  const View rows = arena.matrix(d_, s_ * d_);
  for (int i = 0; i < s_; ++i) {
    const Stage& stage = stages_[index(i)];
    if (!is_ordinary_) multiply(1.0, Op::plain, stage.L, Op::plain, T2_, 0.0, rows);
    for (int j = 0; j < s_; ++j) {
      const double weight = stage.tau / h * method.D_at(i, j);
      const ConstView from = is_ordinary_ ? ConstView(stage.L) : ConstView(rows.columns(j * d_, d_));
      for (int k = 0; k < d_; ++k)
        for (int r = 0; r < d_; ++r) M(i * d_ + r, j * d_ + k) = weight * from(r, k);
    }
    for (int k = 0; k < d_; ++k)
      for (int r = 0; r < d_; ++r) M(i * d_ + r, i * d_ + k) -= stage.B(r, k);
  }
  return factor_lu(M, pivots_.data());
}

bool SensitivityStages::solve(const StageMethod& method, double h, ConstView S_start, Arena& arena) {
  const View z = z_;
  const Arena::Frame frame(arena);
  const View slopes = arena.matrix(n_, count_);
  for (int i = 0; i < s_; ++i) {
    const Stage& stage = stages_[index(i)];
    const View right = z.block(i * d_, 0, d_, count_);
    fill(slopes, 0.0);
    for (int j = 0; j < s_; ++j) {
      const double weight = stage.tau / h * method.D_at(i, j);
      for (int q = 0; q < count_; ++q)
        for (int k = 0; k < n_; ++k) slopes(k, q) -= weight * (stages_[index(j)].xp(k, q) - S_start(k, q));
    }
    copy(stage.b, right);
    multiply(1.0, Op::plain, stage.L, Op::plain, slopes, 1.0, right);
  }
  if (!factor(method, h, arena)) return false;
  solve_lu(matrix_.view().top(s_ * d_), pivots_.data(), z);
  return true;
}

void SensitivityStages::solve_transposed(View weights) const {
  solve_lu_transposed(matrix_.view().top(s_ * d_), pivots_.data(), weights);
}

bool SensitivityStages::map_errors(ConstView errors, View mapped, Arena& arena) const {
  if (is_ordinary_) {
    copy(errors, mapped);
    return true;
  }
  const Arena::Frame frame(arena);
  const Stage& last = stages_.back();
  const View G = arena.matrix(d_, d_), z = arena.matrix(d_, errors.cols);
  multiply(1.0, Op::plain, last.L, Op::plain, T2(s_ - 1), 0.0, G);
  multiply(1.0, Op::plain, last.L, Op::plain, errors, 0.0, z);
  int* const pivots = arena.integers(d_ + 1);
  if (!factor_lu(G, pivots)) return false;
  solve_lu(G, pivots, z);
  multiply(1.0, Op::plain, T2(s_ - 1), Op::plain, z, 0.0, mapped);
  return true;
}

void SensitivityStages::expand(int i, View S) const {
  const Stage& stage = stages_[index(i)];
  if (is_ordinary_) return copy(z_.view().block(i * d_, 0, d_, count_), S);
  copy(stage.xp, S);
  multiply(1.0, Op::plain, T2(i), Op::plain, z_.view().block(i * d_, 0, d_, count_), 1.0, S);
}

}  // namespace sfdae::core
