// Staged elimination of the derivative array.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/elimination.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "linalg/dense.h"

namespace sfdae::core {

namespace {

// Multipliers C R^-1 replace rotations while they are below this: errors grow by no more than two digits, which
// the noise of the judge covers.
constexpr double largest_multiplier = 100.0;

// Rows of errors that are eliminated along with the rows carried, above them: what becomes of the errors that enter at
// every stage is their size at the end.
constexpr int error_rows = 1;

// E_0 P = Q [R11 R12; 0 0], computed once for all stages.
struct DiagonalBlock {
  View factors;
  int* pivots;
  int rank;
  View Q;  // m x m
  int null_columns() const { return factors.cols - rank; }
  int null_rows() const { return factors.rows - rank; }
};

DiagonalBlock factor_diagonal_block(const TaylorData& data, Judge& judge, Arena& arena) {
  const ConstView E0 = data.E(0);
  DiagonalBlock block{arena.matrix(data.m, data.n), arena.integers(data.n), 0, arena.matrix(data.m, data.m)};
  copy(E0, block.factors);
  double* tau = arena.take(static_cast<std::size_t>(std::min(data.m, data.n)) + 1);
  factor_qr_pivoted(block.factors, block.pivots, tau, arena);
  block.rank = judge.decide_diagonal_block(block.factors, E0);
  form_q(block.factors, block.rank, tau, block.Q, arena);
  return block;
}

// result += W (E_p - A_q / j), the block of the array at column j; blocks that vanish cost nothing.
void add_block(const TaylorData& data, int p, int j, ConstView W, View result, Arena& arena) {
  const bool no_E = data.is_zero_E(p);
  const bool no_A = data.is_zero_A(p - 1);
  if (no_E && no_A) return;
  if (no_A) return multiply(1.0, Op::plain, W, Op::plain, data.E(p), 1.0, result);
  if (no_E) return multiply(-1.0 / j, Op::plain, W, Op::plain, data.A(p - 1), 1.0, result);
  const Arena::Frame frame(arena);
  const View F = arena.matrix(data.m, data.n);
  for (int col = 0; col < data.n; ++col) {
    const double* e = data.E(p).column(col);
    const double* a = data.A(p - 1).column(col);
    double* to = F.column(col);
    for (int row = 0; row < data.m; ++row) to[row] = e[row] - a[row] / j;
  }
  multiply(1.0, Op::plain, W, Op::plain, F, 1.0, result);
}

// result += W [block row i of the array without column y_{i+1}], columns y_1..y_i, x, rhs.
void add_block_row(const TaylorData& data, int i, ConstView rhs, ConstView W, View result, Arena& arena) {
  const int n = data.n;
  for (int j = 1; j <= i; ++j) add_block(data, i + 1 - j, j, W, result.columns((j - 1) * n, n), arena);
  if (!data.is_zero_A(i)) multiply(1.0, Op::plain, W, Op::plain, data.A(i), 1.0, result.columns(i * n, n));
  if (rhs.cols > 0)
    multiply(1.0, Op::plain, W, Op::plain, rhs.block(i * data.m, 0, data.m, rhs.cols), 1.0,
             result.columns((i + 1) * n, rhs.cols));
}

// Columns pivots[first..first+count) of y_j in `carried`.
void gather(ConstView carried, int offset, const int* pivots, View to) {
  for (int q = 0; q < to.cols; ++q) std::copy_n(carried.column(offset + pivots[q]), to.rows, to.column(q));
}

// The stage's stack is [R11 R12 | Q1^T F; C1 C2 | C3] with F the block row and C carried from the stages before.
// Eliminates C1 and leaves T = what becomes of C2 (to be judged) and, in the first rows of `next`, of C3.
// Gauss: L = C1 R11^-1, T = C2 - L R12, C3 - L Q1^T F. False if L is too large.
bool eliminate_by_multipliers(const DiagonalBlock& block, View C1, View T, View W_carried, bool limited = true) {
  const int r = block.rank;
  solve_upper_right(block.factors.block(0, 0, r, r), C1);
  if (limited && max_abs(C1.block(error_rows, 0, C1.rows - error_rows, r)) > largest_multiplier) return false;
  multiply(-1.0, Op::plain, C1, Op::plain, block.factors.block(0, r, r, block.null_columns()), 1.0, T);
  multiply(-1.0, Op::plain, C1, Op::transposed, block.Q.columns(0, r), 0.0, W_carried);
  return true;
}

// Householder: QR of [R11; C1], applied to the columns beside it. rows_F = Q1^T F.
void eliminate_by_reflections(const DiagonalBlock& block, ConstView C1, View T, ConstView rows_F, View next,
                              Arena& arena) {
  const Arena::Frame frame(arena);
  const int r = block.rank, c = T.rows;
  const View X = arena.matrix(r + c, r);
  fill(X, 0.0);
  for (int q = 0; q < r; ++q) std::copy_n(block.factors.column(q), q + 1, X.column(q));
  copy(C1, X.block(r, 0, c, r));
  const View beside = arena.matrix(r + c, T.cols + next.cols);
  copy(block.factors.block(0, r, r, T.cols), beside.block(0, 0, r, T.cols));
  copy(T, beside.block(r, 0, c, T.cols));
  copy(rows_F, beside.block(0, T.cols, r, next.cols));
  copy(next, beside.block(r, T.cols, c, next.cols));
  double* tau = arena.take(static_cast<std::size_t>(r) + 1);
  factor_qr(X, tau, arena);
  apply_q(Op::transposed, X, r, tau, beside, arena);
  copy(beside.block(r, 0, c, T.cols), T);
  copy(beside.block(r, T.cols, c, next.cols), next);
}

// Adds errors of the size given, of either sign.
void add_errors(double size, View errors, std::uint32_t& state) {
  for (int j = 0; j < errors.cols; ++j)
    for (int i = 0; i < errors.rows; ++i) {
      state = 1664525u * state + 1013904223u;
      errors(i, j) += (state & 0x80000000u) != 0 ? size : -size;
    }
}

// One stage: eliminates y_j, j = i + 1, from block row i and the rows carried; returns the rows carried on. The first
// rows of both are those of errors.
View run_stage(const TaylorData& data, const DiagonalBlock& block, int i, View carried, ConstView rhs, Judge& judge,
               Arena& arena) {
  const int n = data.n, m = data.m, r = block.rank, c = carried.rows;
  const int columns = (i + 1) * n + rhs.cols;  // y_1..y_i, x, rhs
  const View next = arena.matrix(c + block.null_rows(), columns);
  copy(carried.columns(0, i * n), next.block(0, 0, c, i * n));
  copy(carried.columns((i + 1) * n, n + rhs.cols), next.block(0, i * n, c, n + rhs.cols));
  fill(next.block(c, 0, block.null_rows(), columns), 0.0);

  const Arena::Frame frame(arena);
  const View W = arena.matrix(c + block.null_rows(), m);  // next += W F
  for (int row = 0; row < block.null_rows(); ++row)
    for (int k = 0; k < m; ++k) W(c + row, k) = block.Q(k, r + row);
  const View T = arena.matrix(c, block.null_columns());
  const View C1 = arena.matrix(c, r);
  gather(carried, i * n, block.pivots, C1);
  gather(carried, i * n, block.pivots + r, T);
  if (!eliminate_by_multipliers(block, C1, T, W.top(c))) {
      gather(carried, i * n, block.pivots, C1);
      gather(carried, i * n, block.pivots + r, T);
      const View C1_errors = C1.top(error_rows);
      eliminate_by_multipliers(block, C1_errors, T.top(error_rows), W.top(error_rows), false);
      const View rows_F = arena.matrix(r, columns);
      fill(rows_F, 0.0);
      const View Q1t = arena.matrix(r, m);
      for (int row = 0; row < r; ++row)
        for (int k = 0; k < m; ++k) Q1t(row, k) = block.Q(k, row);
      add_block_row(data, i, rhs, Q1t, rows_F, arena);
      const int others = c - error_rows;
      eliminate_by_reflections(block, C1.block(error_rows, 0, others, r), T.block(error_rows, 0, others, T.cols), rows_F,
                               next.block(error_rows, 0, others, columns), arena);
      fill(W.block(error_rows, 0, others, m), 0.0);
  }
  add_block_row(data, i, rhs, W, next, arena);

  // The rest of y_j: rows of T that are independent determine it and leave.
  int leaving = 0;
  if (c > error_rows && T.cols > 0) {
    const View S = arena.matrix(c - error_rows, T.cols);
    copy(T.block(error_rows, 0, S.rows, S.cols), S);
    int* pivots = arena.integers(T.cols);
    double* tau = arena.take(static_cast<std::size_t>(std::min(S.rows, S.cols)) + 1);
    factor_qr_pivoted(S, pivots, tau, arena);
    const View T_errors = T.top(error_rows);
    leaving = judge.decide_stage(i + 1, S, T.block(error_rows, 0, S.rows, S.cols),
                                 max_abs(carried.block(error_rows, i * n, S.rows, n)), max_abs(T_errors));
    apply_q(Op::transposed, S, leaving, tau, next.block(error_rows, 0, S.rows, columns), arena);
    if (leaving > 0) {
      const View L = arena.matrix(error_rows, leaving);
      gather(T_errors, 0, pivots, L);
      solve_upper_right(S.block(0, 0, leaving, leaving), L);
      multiply(-1.0, Op::plain, L, Op::plain, next.block(error_rows, 0, leaving, columns), 1.0, next.top(error_rows));
      for (int j = 0; j < columns; ++j)
        for (int q = error_rows - 1; q >= 0; --q) next(leaving + q, j) = next(q, j);
    }
  }
  const View result = next.block(leaving, 0, next.rows - leaving, columns);
  std::uint32_t state = static_cast<std::uint32_t>(i);
  add_errors(judge.row_error(), result.top(error_rows).columns(0, i * n), state);
  add_errors(judge.constraint_error(), result.top(error_rows).columns(i * n, n), state);
  return result;
}

Carried split(const View& carried, int y_columns, int n, int rhs_columns) {
  Carried result;
  result.rows = carried.rows;
  result.y = carried.columns(0, y_columns);
  result.constraints = carried.columns(y_columns, n);
  result.rhs = carried.columns(y_columns + n, rhs_columns);
  return result;
}

}  // namespace

Carried eliminate(const TaylorData& data, int level, ConstView rhs, int last_stage, Judge& judge, Arena& arena) {
  const DiagonalBlock block = factor_diagonal_block(data, judge, arena);
  View carried = arena.matrix(error_rows, (level + 2) * data.n + rhs.cols);
  fill(carried, 0.0);
  for (int j = level + 1; j >= last_stage; --j) carried = run_stage(data, block, j - 1, carried, rhs, judge, arena);
  judge.set_rows_noise(max_abs(carried.top(error_rows)));
  carried = carried.block(error_rows, 0, carried.rows - error_rows, carried.cols);
  Carried result = split(carried, (last_stage - 1) * data.n, data.n, rhs.cols);
  result.rank_E = block.rank;
  result.R = block.factors;
  result.pivots = block.pivots;
  return result;
}

Matrix taylor_array(const TaylorData& data, int level) {
  const int m = data.m, n = data.n;
  Matrix array((level + 1) * m, (level + 2) * n);
  for (int i = 0; i <= level; ++i) {
    for (int j = 1; j <= i + 1; ++j)
      for (int col = 0; col < n; ++col)
        for (int row = 0; row < m; ++row)
          array(i * m + row, (j - 1) * n + col) =
              data.E(i + 1 - j)(row, col) - (j <= i ? data.A(i - j)(row, col) / j : 0.0);
    copy(data.A(i), array.view().block(i * m, (level + 1) * n, m, n));
  }
  return array;
}

Carried eliminate_by_svd(const TaylorData& data, int level, ConstView rhs, Judge& judge, Arena& arena) {
  const int n = data.n, rows = (level + 1) * data.m;
  const DiagonalBlock block = factor_diagonal_block(data, judge, arena);
  const Matrix array = taylor_array(data, level);
  const Svd decomposition = svd(array.view().columns(0, (level + 1) * n));
  const int rank = judge.decide_array(decomposition.s, rows, (level + 1) * n);
  judge.set_rows_noise(judge.constraint_error());
  const ConstView Z = decomposition.U.view().columns(rank, rows - rank);
  const View carried = arena.matrix(rows - rank, n + rhs.cols);
  multiply(1.0, Op::transposed, Z, Op::plain, array.view().columns((level + 1) * n, n), 0.0, carried.columns(0, n));
  multiply(1.0, Op::transposed, Z, Op::plain, rhs, 0.0, carried.columns(n, rhs.cols));
  Carried result = split(carried, 0, n, rhs.cols);
  result.rank_E = block.rank;
  result.R = block.factors;
  result.pivots = block.pivots;
  return result;
}

}  // namespace sfdae::core
