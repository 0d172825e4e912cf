// A staged elimination stored for further right-hand sides.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/stored_elimination.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Up to this many unknowns the equations of a stage are solved for y_j beforehand: overhead of calls outweighs
// arithmetic. Chosen by timing; no figures were recorded.
constexpr int largest_combined = 12;

View column(double* values, int rows) { return {values, rows, 1, std::max(rows, 1)}; }

}  // namespace

void StoredElimination::Block::resize(int new_rows, int new_cols) {
  entries.resize(index(new_rows) * index(new_cols) + 1);
  rows = new_rows;
  cols = new_cols;
}

void StoredElimination::Block::keep(ConstView from) {
  resize(from.rows, from.cols);
  copy(from, {entries.data(), rows, cols, std::max(rows, 1)});
}

StoredElimination::StageView StoredElimination::stage(int i) const {
  const Stage& stage = stages_[index(i)];
  const Diagonal& diagonal = diagonal_of(stage);
  return {diagonal.rank,        diagonal.null_rows,     stage.leaving,       stage.rhs,
          stage.by_reflections, diagonal.R.view(),      diagonal.Q.view(),   stage.W.view(),
          stage.X.view(),       stage.T.view(),         stage.rows.view(),   stage.X_tau.data(),
          stage.T_tau.data(),   diagonal.pivots.data(), stage.pivots.data(), stage.solution.view()};
}

bool StoredElimination::is_combined() const { return n_ <= largest_combined; }

void StoredElimination::begin(const TaylorData& data, int level) {
  m_ = data.m;
  n_ = data.n;
  level_ = level;
  num_diagonals_ = 0;
  if (stages_.size() < index(level + 1)) stages_.resize(index(level + 1));
}

void StoredElimination::keep_diagonal_block(ConstView factors, const int* pivots, ConstView Q, int rank) {
  if (diagonals_.size() == num_diagonals_) diagonals_.emplace_back();
  Diagonal& diagonal = diagonals_[num_diagonals_++];
  diagonal.rank = rank;
  diagonal.null_rows = factors.rows - rank;
  diagonal.R.keep(factors.top(rank));
  diagonal.Q.keep(Q);
  diagonal.pivots.assign(pivots, pivots + n_);
}

void StoredElimination::begin_stage(int i, int carried) {
  stage_ = &stages_[index(i)];
  stage_->diagonal = num_diagonals_ - 1;
  stage_->carried = carried;
  stage_->leaving = 0;
  stage_->by_reflections = false;
  carried_ = carried + diagonal_of(*stage_).null_rows;
}

void StoredElimination::keep_reflections(ConstView X, const double* tau) {
  stage_->by_reflections = true;
  stage_->X.keep(X);
  stage_->X_tau.assign(tau, tau + X.cols);
}

void StoredElimination::keep_combination(ConstView W) { stage_->W.keep(W); }

void StoredElimination::keep_leaving(ConstView T, const int* pivots, const double* tau, ConstView rows) {
  stage_->leaving = rows.rows;
  stage_->T.keep(T);
  stage_->T_tau.assign(tau, tau + std::min(T.rows, T.cols));
  stage_->pivots.assign(pivots, pivots + T.cols);
  stage_->rows.keep(rows.columns(0, rows.cols));
  carried_ -= rows.rows;
}

void StoredElimination::finish(const TaylorData& data, Arena& arena) {
  int at = carried_;
  for (int i = level_; i >= 0; --i) {
    stages_[index(i)].rhs = at;
    at += stages_[index(i)].leaving;
    if (is_combined()) combine(data, i, arena);
  }
}

// Q1^T times block row i without y_j, then the equations of the stage solved for y_j.
void StoredElimination::combine(const TaylorData& data, int i, Arena& arena) {
  Stage& stage = stages_[index(i)];
  const Diagonal& diagonal = diagonal_of(stage);
  const ConstView R = diagonal.R.view();
  const std::vector<int>& pivots = diagonal.pivots;
  const int rank = diagonal.rank, q = stage.leaving, at_x = m_ + q, columns = at_x + (i + 1) * n_;
  const Arena::Frame frame(arena);
  const View B = arena.matrix(rank, columns), T = arena.matrix(q, columns);
  const ConstView Q1 = diagonal.Q.view().columns(0, rank);
  fill(B, 0.0);
  fill(T, 0.0);
  for (int row = 0; row < rank; ++row)
    for (int k = 0; k < m_; ++k) B(row, k) = Q1(k, row);
  if (!data.is_zero_A(i)) multiply(1.0, Op::transposed, Q1, Op::plain, data.A(i), 0.0, B.columns(at_x, n_));
  for (int k = 1; k <= i; ++k) {
    const View to = B.columns(at_x + k * n_, n_);
    if (!data.is_zero_E(i + 1 - k)) multiply(-1.0, Op::transposed, Q1, Op::plain, data.E(i + 1 - k), 1.0, to);
    if (!data.is_zero_A(i - k)) multiply(1.0 / k, Op::transposed, Q1, Op::plain, data.A(i - k), 1.0, to);
  }
  stage.solution.resize(n_, columns);
  const View G = stage.solution.view();
  fill(G, 0.0);
  if (q > 0) {
    const ConstView rows = stage.rows.view();
    for (int row = 0; row < q; ++row) {
      T(row, m_ + row) = 1.0;
      for (int c = 0; c < n_; ++c) T(row, at_x + c) = rows(row, i * n_ + c);
      for (int c = 0; c < i * n_; ++c) T(row, at_x + n_ + c) = -rows(row, c);
    }
    solve_upper(Op::plain, stage.T.view().block(0, 0, q, q), T);
    for (int row = 0; row < q; ++row) {
      const int column = rank + stage.pivots[index(row)];
      for (int c = 0; c < columns; ++c) G(pivots[index(column)], c) = T(row, c);
      for (int c = 0; c < columns; ++c)
        for (int r = 0; r < rank; ++r) B(r, c) -= R(r, column) * T(row, c);
    }
  }
  solve_upper(Op::plain, R.columns(0, rank), B);
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < rank; ++r) G(pivots[index(r)], c) = B(r, c);
}

void StoredElimination::transform(const double* f, double* transformed, Arena& arena) const {
  const Arena::Frame frame(arena);
  const int most = (level_ + 1) * m_;
  double* now = arena.take(index(most) + 1);
  double* next = arena.take(index(most + m_) + 1);
  double* stacked = arena.take(index(most + m_) + 1);
  int rows = 0;
  for (int i = level_; i >= 0; --i) {
    const Stage& stage = stages_[index(i)];
    const Diagonal& diagonal = diagonal_of(stage);
    const int rank = diagonal.rank;
    const double* f_i = f + static_cast<std::ptrdiff_t>(i) * m_;
    const int after = rows + diagonal.null_rows;
    std::copy_n(now, rows, next);
    if (stage.by_reflections) {
      multiply(1.0, Op::transposed, diagonal.Q.view().columns(0, rank), f_i, 0.0, stacked);
      std::copy_n(now, rows, stacked + rank);
      apply_q(Op::transposed, stage.X.view(), rank, stage.X_tau.data(), column(stacked, rank + rows), arena);
      std::copy_n(stacked + rank, rows, next);
    }
    std::fill_n(next + rows, diagonal.null_rows, 0.0);
    multiply(1.0, Op::plain, stage.W.view(), f_i, 1.0, next);
    if (stage.leaving > 0) {
      apply_q(Op::transposed, stage.T.view(), stage.leaving, stage.T_tau.data(), column(next, rows), arena);
      std::copy_n(next, stage.leaving, transformed + stage.rhs);
    }
    rows = after - stage.leaving;
    std::copy_n(next + stage.leaving, rows, now);
  }
  std::copy_n(now, rows, transformed);
}

// The stages of transform() in reverse order.
void StoredElimination::transform_transposed(const double* weights, double* weights_of_f, Arena& arena) const {
  const Arena::Frame frame(arena);
  const int most = (level_ + 2) * m_;
  double* now = arena.take(index(most) + 1);
  double* next = arena.take(index(most) + 1);
  double* stacked = arena.take(index(most) + 1);
  std::copy_n(weights, carried_, now);
  for (int i = 0; i <= level_; ++i) {
    const Stage& stage = stages_[index(i)];
    const Diagonal& diagonal = diagonal_of(stage);
    const int rank = diagonal.rank, rows = stage.carried, after = rows + diagonal.null_rows;
    double* f_i = weights_of_f + static_cast<std::ptrdiff_t>(i) * m_;
    std::fill_n(next, stage.leaving, 0.0);
    std::copy_n(now, after - stage.leaving, next + stage.leaving);
    if (stage.leaving > 0)
      apply_q(Op::plain, stage.T.view(), stage.leaving, stage.T_tau.data(), column(next, rows), arena);
    multiply(1.0, Op::transposed, stage.W.view(), next, 0.0, f_i);
    if (stage.by_reflections) {
      std::fill_n(stacked, rank, 0.0);
      std::copy_n(next, rows, stacked + rank);
      apply_q(Op::plain, stage.X.view(), rank, stage.X_tau.data(), column(stacked, rank + rows), arena);
      multiply(1.0, Op::plain, diagonal.Q.view().columns(0, rank), stacked, 1.0, f_i);
      std::copy_n(stacked + rank, rows, now);
    } else {
      std::copy_n(next, rows, now);
    }
  }
}

void StoredElimination::recover(const TaylorData& data, RightHandSide rhs, const double* x, double* y,
                                Arena& arena) const {
  if (!is_combined()) {
    for (int i = 0; i <= level_; ++i) solve_stage({data, rhs, x}, i, y, arena);
    return;
  }
  const Arena::Frame frame(arena);
  double* known = arena.take(index(2 * m_ + (level_ + 2) * n_));
  for (int i = 0; i <= level_; ++i) {
    const Stage& stage = stages_[index(i)];
    std::copy_n(rhs.f + static_cast<std::ptrdiff_t>(i) * m_, m_, known);
    std::copy_n(rhs.transformed + stage.rhs, stage.leaving, known + m_);
    std::copy_n(x, n_, known + m_ + stage.leaving);
    std::copy_n(y, i * n_, known + m_ + stage.leaving + n_);
    multiply(1.0, Op::plain, stage.solution.view(), known, 0.0, y + static_cast<std::ptrdiff_t>(i) * n_);
  }
}

void StoredElimination::solve_stage(const Known& known, int i, double* y, Arena& arena) const {
  const TaylorData& data = known.data;
  const RightHandSide& rhs = known.rhs;
  const double* x = known.x;
  const Arena::Frame frame(arena);
  const Stage& stage = stages_[index(i)];
  const Diagonal& diagonal = diagonal_of(stage);
  const ConstView R = diagonal.R.view();
  const std::vector<int>& pivots = diagonal.pivots;
  const int rank = diagonal.rank;
  const int free_columns = n_ - rank;
  double* r = arena.take(index(m_) + 1);
  double* top = arena.take(index(m_) + 1);
  // Rows leaving: T P_q y_q = rhs - rows [y_1; ...; y_i; x], in the sense M y - N x = f.
  double* y_q = arena.zeros(index(n_) + 1);
  if (stage.leaving > 0) {
    const ConstView rows = stage.rows.view();
    double* b = arena.take(index(stage.leaving) + 1);
    std::copy_n(rhs.transformed + stage.rhs, stage.leaving, b);
    for (int j = 0; j < i; ++j)
      multiply(-1.0, Op::plain, rows.columns(j * n_, n_), y + static_cast<std::ptrdiff_t>(j) * n_, 1.0, b);
    multiply(1.0, Op::plain, rows.columns(i * n_, n_), x, 1.0, b);
    solve_upper(Op::plain, stage.T.view().block(0, 0, stage.leaving, stage.leaving), column(b, stage.leaving));
    for (int k = 0; k < stage.leaving; ++k) y_q[stage.pivots[index(k)]] = b[k];
  }
  // E_0 y_j = f_i + A_i x - sum_k (E_{i+1-k} - A_{i-k} / k) y_k
  std::copy_n(rhs.f + static_cast<std::ptrdiff_t>(i) * m_, m_, r);
  if (!data.is_zero_A(i)) multiply(1.0, Op::plain, data.A(i), x, 1.0, r);
  for (int k = 1; k <= i; ++k) {
    const double* y_k = y + static_cast<std::ptrdiff_t>(k - 1) * n_;
    if (!data.is_zero_E(i + 1 - k)) multiply(-1.0, Op::plain, data.E(i + 1 - k), y_k, 1.0, r);
    if (!data.is_zero_A(i - k)) multiply(1.0 / k, Op::plain, data.A(i - k), y_k, 1.0, r);
  }
  multiply(1.0, Op::transposed, diagonal.Q.view().columns(0, rank), r, 0.0, top);
  multiply(-1.0, Op::plain, R.columns(rank, free_columns), y_q, 1.0, top);
  solve_upper(Op::plain, R.columns(0, rank), column(top, rank));
  double* y_j = y + static_cast<std::ptrdiff_t>(i) * n_;
  for (int k = 0; k < rank; ++k) y_j[pivots[index(k)]] = top[k];
  for (int k = 0; k < free_columns; ++k) y_j[pivots[index(rank + k)]] = y_q[k];
}

void StoredElimination::mark_determined(std::vector<char>& flags) const {
  flags.assign(index(n_) * index(level_ + 1), 0);
  for (int i = 0; i <= level_; ++i) {
    const Stage& stage = stages_[index(i)];
    const std::vector<int>& pivots = diagonal_of(stage).pivots;
    const int rank = diagonal_of(stage).rank;
    char* of_stage = flags.data() + static_cast<std::ptrdiff_t>(i) * n_;
    for (int k = 0; k < rank; ++k) of_stage[pivots[index(k)]] = 1;
    for (int k = 0; k < stage.leaving; ++k) of_stage[pivots[index(rank + stage.pivots[index(k)])]] = 1;
  }
}

}  // namespace sfdae::core
