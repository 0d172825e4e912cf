// The stages of an implicit Runge-Kutta step of sensitivities.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/sensitivity_stages.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

void SensitivityStages::resize(int s, int n, int d, int count) {
  if (s == s_ && n == n_ && d == d_ && count == count_) return;
  s_ = 0;  // while memory may be missing
  Stage stage;
  stage.T2 = Matrix(n, d);
  stage.xp = Matrix(n, count);
  stage.L = Matrix(d, n);
  stage.B = Matrix(d, d);
  stage.b = Matrix(d, count);
  stages_.assign(index(s), stage);
  matrix_ = Matrix(padded_rows(s * d), s * d);
  z_ = Matrix(s * d, count);
  pivots_.assign(index(s * d) + 1, 0);
  s_ = s;
  n_ = n;
  d_ = d;
  count_ = count;
}

void SensitivityStages::keep(int i, const SensitivityPoint& point) {
  Stage& stage = stages_[index(i)];
  is_ordinary_ = point.is_ordinary();
  copy(point.ZE(), stage.L);
  copy(point.Zf(), stage.b);
  if (is_ordinary_) {
    copy(point.ZA(), stage.B);
  } else {
    copy(point.T2(), stage.T2);
    copy(point.xp(), stage.xp);
    multiply(1.0, Op::plain, point.ZA(), Op::plain, point.T2(), 0.0, stage.B);
    multiply(1.0, Op::plain, point.ZA(), Op::plain, point.xp(), 1.0, stage.b);
  }
  stage.tau = point.time_scale();
}

bool SensitivityStages::solve(const StageMethod& method, double h, ConstView S_start, Arena& arena) {
  const View M = matrix_.view().top(s_ * d_), z = z_;
  const Arena::Frame frame(arena);
  const View slopes = arena.matrix(n_, count_), rows = arena.matrix(d_, d_);
  for (int i = 0; i < s_; ++i) {
    const Stage& stage = stages_[index(i)];
    const double factor = stage.tau / h;
    const View right = z.block(i * d_, 0, d_, count_);
    fill(slopes, 0.0);
    for (int j = 0; j < s_; ++j) {
      const double weight = factor * method.D_at(i, j);
      if (is_ordinary_) copy(stage.L, rows);
      else multiply(1.0, Op::plain, stage.L, Op::plain, stages_[index(j)].T2, 0.0, rows);
      for (int k = 0; k < d_; ++k)
        for (int r = 0; r < d_; ++r) M(i * d_ + r, j * d_ + k) = weight * rows(r, k);
      for (int q = 0; q < count_; ++q)
        for (int k = 0; k < n_; ++k) slopes(k, q) -= weight * (stages_[index(j)].xp(k, q) - S_start(k, q));
    }
    for (int k = 0; k < d_; ++k)
      for (int r = 0; r < d_; ++r) M(i * d_ + r, i * d_ + k) -= stage.B(r, k);
    copy(stage.b, right);
    multiply(1.0, Op::plain, stage.L, Op::plain, slopes, 1.0, right);
  }
  if (!factor_lu(M, pivots_.data())) return false;
  solve_lu(M, pivots_.data(), z);
  return true;
}

void SensitivityStages::expand(int i, View S) const {
  const Stage& stage = stages_[index(i)];
  if (is_ordinary_) return copy(z_.view().block(i * d_, 0, d_, count_), S);
  copy(stage.xp, S);
  multiply(1.0, Op::plain, stage.T2, Op::plain, z_.view().block(i * d_, 0, d_, count_), 1.0, S);
}

}  // namespace sfdae::core
