// Staged elimination of the derivative array.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/elimination.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/kernels_in_use.h"
#include "reduction/stored_elimination.h"

namespace sfdae::core {

namespace {

// Multipliers C R^-1 replace rotations while they are below this: errors grow by at most two digits, which the noise of
// the judge covers.
constexpr double largest_multiplier = 100.0;

// Common data of all stages.
struct Elimination {
  const TaylorData& data;
  ConstView rhs;
  Judge& judge;
  Arena& arena;
  StoredElimination* store;
};

// E_0 P = Q [R11 R12; 0 0], computed once for all stages with the same rows. Rows that are left out are zero in Q.
struct DiagonalBlock {
  View factors;
  int* pivots = nullptr;
  int rank = 0;
  View Q;  // m x number of rows
  int sign_of_Q = 1;
  int null_columns() const { return factors.cols - rank; }
  int null_rows() const { return factors.rows - rank; }
};

// The rows of level i among those of `from`, one below the other.
int gather_rows(const TaylorData& data, int i, ConstView from, View to) {
  int count = 0;
  for (int row = 0; row < data.m; ++row) {
    if (!data.has_row(row, i)) continue;
    for (int col = 0; col < to.cols; ++col) to(count, col) = from(row, col);
    ++count;
  }
  return count;
}

// Diagonal block of level i, where some rows may be left out.
DiagonalBlock factor_rows_of_level(const TaylorData& data, int i, Judge& judge, Arena& arena) {
  const View all = arena.matrix(data.m, data.n);
  const int rows = gather_rows(data, i, data.E(0), all);
  DiagonalBlock block{arena.matrix(rows, data.n), arena.integers(data.n), 0, arena.matrix(data.m, rows)};
  for (int col = 0; col < data.n; ++col) block.pivots[col] = col;
  fill(block.Q, 0.0);
  if (rows == 0) return block;
  copy(all.top(rows), block.factors);
  double* tau = arena.take(index(std::min(rows, data.n)) + 1);
  factor_qr_pivoted(block.factors, block.pivots, tau, arena, judge.negligible(judge.norm_E0()));
  block.rank = judge.decide_diagonal_block(block.factors, all.top(rows));
  const View Q = arena.matrix(rows, rows);
  form_q(block.factors, block.rank, tau, Q, arena);
  int count = 0;
  for (int row = 0; row < data.m; ++row) {
    if (!data.has_row(row, i)) continue;
    for (int col = 0; col < rows; ++col) block.Q(row, col) = Q(count, col);
    ++count;
  }
  return block;
}

DiagonalBlock factor_diagonal_block(const TaylorData& data, int i, Judge& judge, Arena& arena) {
  if (i > 0 && !data.differentiations.empty()) return factor_rows_of_level(data, i, judge, arena);
  const ConstView E0 = data.E(0);
  DiagonalBlock block{arena.matrix(data.m, data.n), arena.integers(data.n), 0, arena.matrix(data.m, data.m)};
  double* tau = arena.take(index(std::min(data.m, data.n)) + 1);
  const double negligible = judge.negligible(judge.norm_E0());
  if (KeptFactorizations* kept = data.kept_factorizations(); kept != nullptr) {
    kept->factor(E0, negligible, block.factors, block.pivots, tau, arena);
    block.rank = judge.decide_diagonal_block(block.factors, E0);
    kept->form_q(block.factors, block.rank, tau, block.Q, arena);
  } else {
    copy(E0, block.factors);
    factor_qr_pivoted(block.factors, block.pivots, tau, arena, negligible);
    block.rank = judge.decide_diagonal_block(block.factors, E0);
    form_q(block.factors, block.rank, tau, block.Q, arena);
  }
  block.sign_of_Q = reflections_sign(tau, block.rank);
  return block;
}

// result += W (E_p - A_q / j), the block of the array at column j; blocks that vanish cost nothing.
void add_block(const Elimination& of, int p, int j, ConstView W, View result) {
  const TaylorData& data = of.data;
  const bool no_E = data.is_zero_E(p);
  const bool no_A = data.is_zero_A(p - 1);
  if (no_E && no_A) return;
  if (no_A) return multiply(1.0, Op::plain, W, Op::plain, data.E(p), 1.0, result);
  if (no_E) return multiply(-1.0 / j, Op::plain, W, Op::plain, data.A(p - 1), 1.0, result);
  const Arena::Frame frame(of.arena);
  const View F = of.arena.matrix(data.m, data.n);
  const double part = 1.0 / j;
  const auto subtract = kernels::loops().arrays.subtract;
  for (int col = 0; col < data.n; ++col)
    subtract(data.E(p).column(col), part, data.A(p - 1).column(col), data.m, F.column(col));
  multiply(1.0, Op::plain, W, Op::plain, F, 1.0, result);
}

// result += W [block row i of the array without column y_{i+1}], columns y_1..y_i, x, rhs.
void add_block_row(const Elimination& of, int i, ConstView W, View result) {
  const TaylorData& data = of.data;
  const ConstView rhs = of.rhs;
  const int n = data.n;
  for (int j = 1; j <= i; ++j) add_block(of, i + 1 - j, j, W, result.columns((j - 1) * n, n));
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
// Eliminates C1 and leaves T, the transformed C2 (to be judged), and, in the first rows of `next`, the transformed C3.
// Gauss: T = C2 - L R12, C3 - L Q1^T F with L = C1 R11^-1.
void eliminate_by_multipliers(const DiagonalBlock& block, ConstView L, View T, View W_carried) {
  const int r = block.rank;
  multiply(-1.0, Op::plain, L, Op::plain, block.factors.block(0, r, r, block.null_columns()), 1.0, T);
  multiply(-1.0, Op::plain, L, Op::transposed, block.Q.columns(0, r), 0.0, W_carried);
}

void scale(double factor, View rows) {
  for (int col = 0; col < rows.cols; ++col)
    for (int row = 0; row < rows.rows; ++row) rows(row, col) *= factor;
}

// Errors of the size given, of either sign; the same ones in every run.
void add_errors(double size, unsigned seed, View errors) {
  std::minstd_rand random(seed);
  for (int col = 0; col < errors.cols; ++col)
    for (int row = 0; row < errors.rows; ++row) errors(row, col) += random() % 2 == 0 ? size : -size;
}

// The rows carried in that stack: C1, C2 (T) and C3.
struct Stack {
  ConstView C1;
  View T, next;
};

// Householder: QR of [R11; C1], applied to the remaining columns. rows_F = Q1^T F. Rows with large multipliers become
// shorter, and their errors with them: returns an upper bound of the factor, at most 1.
double eliminate_by_reflections(const Elimination& of, const DiagonalBlock& block, const Stack& stack,
                                ConstView rows_F) {
  Arena& arena = of.arena;
  const auto& [C1, T, next] = stack;
  const Arena::Frame frame(arena);
  const int r = block.rank, c = T.rows;
  const View X = arena.matrix(r + c, r);
  fill(X, 0.0);
  for (int q = 0; q < r; ++q) std::copy_n(block.factors.column(q), q + 1, X.column(q));
  copy(C1, X.block(r, 0, c, r));
  const View beside = arena.matrix(r + c, T.cols + next.cols + c);
  copy(block.factors.block(0, r, r, T.cols), beside.block(0, 0, r, T.cols));
  copy(T, beside.block(r, 0, c, T.cols));
  copy(rows_F, beside.block(0, T.cols, r, next.cols));
  copy(next, beside.block(r, T.cols, c, next.cols));
  // Transformation of the rows themselves: a sample of errors could be one of the combinations that shrink.
  const View mixing = beside.columns(T.cols + next.cols, c);
  fill(mixing, 0.0);
  for (int row = 0; row < c; ++row) mixing(r + row, row) = 1.0;
  double* tau = arena.take(index(r) + 1);
  factor_qr(X, tau, arena);
  apply_q(Op::transposed, X, r, tau, beside, arena);
  if (of.store != nullptr) of.store->keep_reflections(X, tau);
  copy(beside.block(r, 0, c, T.cols), T);
  copy(beside.block(r, T.cols, c, next.cols), next);
  return std::min(1.0, std::sqrt(static_cast<double>(c)) * max_abs(mixing.block(r, 0, c, c)));
}

// The part of the block row i that determines y_j: Q1^T F.
View determining_rows(const Elimination& of, const DiagonalBlock& block, int i) {
  const int m = of.data.m;
  const View rows = of.arena.matrix(block.rank, (i + 1) * of.data.n + of.rhs.cols);
  fill(rows, 0.0);
  const Arena::Frame frame(of.arena);
  const View Q1t = of.arena.matrix(block.rank, m);
  for (int row = 0; row < block.rank; ++row)
    for (int k = 0; k < m; ++k) Q1t(row, k) = block.Q(k, row);
  add_block_row(of, i, Q1t, rows);
  return rows;
}

// The rest of y_j: independent rows of T determine it and leave. Rows of errors come first in T and `rows`, at the end
// after those that leave. norm: of the rows of the stage in y_j. Returns the number of rows that leave.
int release_rows(const Elimination& of, View T, double norm, int j, View rows) {
  Judge& judge = of.judge;
  Arena& arena = of.arena;
  const int error_rows = judge.error_rows(), c = T.rows - error_rows;
  if (c == 0 || T.cols == 0) return 0;
  const View errors = T.top(error_rows), factors = T.block(error_rows, 0, c, T.cols);
  const View others = rows.block(error_rows, 0, c, rows.cols);
  ConstView original;
  if (judge.keeps_originals()) {
    const View kept = arena.matrix(c, T.cols);
    copy(factors, kept);
    original = kept;
  }
  int* pivots = arena.integers(T.cols);
  double* tau = arena.take(index(std::min(c, T.cols)) + 1);
  factor_qr_pivoted(factors, pivots, tau, arena, judge.negligible(std::max(norm, judge.norm_E0())));
  judge.set_errors(max_abs(errors));
  const int leaving = judge.decide_stage(j, factors, original, norm);
  apply_q(Op::transposed, factors, leaving, tau, others, arena);
  if (of.store != nullptr) of.store->keep_leaving(factors, pivots, tau, others.top(leaving));
  if (leaving == 0) return 0;
  const View L = arena.matrix(error_rows, leaving);
  gather(errors, 0, pivots, L);
  solve_upper_right(factors.block(0, 0, leaving, leaving), L);
  multiply(-1.0, Op::plain, L, Op::plain, others.top(leaving), 1.0, rows.top(error_rows));
  for (int col = 0; col < rows.cols; ++col)
    for (int row = error_rows; row-- > 0;) rows(leaving + row, col) = rows(row, col);
  return leaving;
}

// One stage: eliminates y_j, j = i + 1, from block row i and the rows carried; returns the rows carried on.
View run_stage(const Elimination& of, const DiagonalBlock& block, int i, View carried) {
  Judge& judge = of.judge;
  Arena& arena = of.arena;
  const int n = of.data.n, m = of.data.m, r = block.rank, c = carried.rows, error_rows = judge.error_rows();
  const int columns = (i + 1) * n + of.rhs.cols;  // y_1..y_i, x, rhs
  const View next = arena.matrix(c + block.null_rows(), columns);
  copy(carried.columns(0, i * n), next.block(0, 0, c, i * n));
  copy(carried.columns((i + 1) * n, n + of.rhs.cols), next.block(0, i * n, c, n + of.rhs.cols));
  fill(next.block(c, 0, block.null_rows(), columns), 0.0);

  const Arena::Frame frame(arena);
  if (of.store != nullptr) of.store->begin_stage(i, c);
  const View W = arena.matrix(c + block.null_rows(), m);  // next += W F
  for (int row = 0; row < block.null_rows(); ++row)
    for (int k = 0; k < m; ++k) W(c + row, k) = block.Q(k, r + row);
  const View C1 = arena.matrix(c, r), T = arena.matrix(c, block.null_columns());
  gather(carried, i * n, block.pivots, C1);
  gather(carried, i * n, block.pivots + r, T);
  solve_upper_right(block.factors.block(0, 0, r, r), C1);
  const int others = c - error_rows;
  const bool moderate = max_abs(C1.block(error_rows, 0, others, r)) <= largest_multiplier;
  const int by_multipliers = moderate ? c : error_rows;
  eliminate_by_multipliers(block, C1.top(by_multipliers), T.top(by_multipliers), W.top(by_multipliers));
  double shortening = 1.0;
  if (!moderate) {
    gather(carried, i * n, block.pivots, C1);
    const Stack stack{C1.block(error_rows, 0, others, r), T.block(error_rows, 0, others, T.cols),
                      next.block(error_rows, 0, others, columns)};
    shortening = eliminate_by_reflections(of, block, stack, determining_rows(of, block, i));
    fill(W.block(error_rows, 0, others, m), 0.0);
  }
  if (of.store != nullptr) of.store->keep_combination(W);
  add_block_row(of, i, W, next);
  if (!moderate) {
    scale(shortening, T.top(error_rows));
    scale(shortening, next.top(error_rows));
  }

  const double norm = max_abs(carried.block(error_rows, i * n, others, n));
  const int leaving = release_rows(of, T, norm, i + 1, next.top(c));
  const View result = next.block(leaving, 0, next.rows - leaving, columns);
  const unsigned seed = static_cast<unsigned>(i) + 1;
  add_errors(judge.entering_error(), seed, result.block(0, 0, error_rows, i * n));
  add_errors(judge.entering_constraint_error(), seed, result.block(0, i * n, error_rows, n));
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

Carried eliminate(const TaylorData& data, int level, ConstView rhs, int last_stage, Judge& judge, Arena& arena,
                  StoredElimination* store) {
  assert(store == nullptr || judge.error_rows() == 0);
  const Elimination of{data, rhs, judge, arena, store};
  DiagonalBlock block = factor_diagonal_block(data, level, judge, arena);
  if (store != nullptr) {
    store->begin(data, level);
    store->keep_diagonal_block(block.factors, block.pivots, block.Q, block.rank);
  }
  const int error_rows = judge.error_rows();
  View carried = arena.matrix(error_rows, (level + 2) * data.n + rhs.cols);
  fill(carried, 0.0);
  // Rounding errors of E_0 are not annihilated by its left null vectors: errors of the first stage.
  add_errors(judge.diagonal_error(), 1, carried.block(0, level * data.n, error_rows, data.n));
  for (int i = level; i >= last_stage - 1; --i) {
    if (i < level && data.has_last_rows(i)) {
      block = factor_diagonal_block(data, i, judge, arena);
      if (store != nullptr) store->keep_diagonal_block(block.factors, block.pivots, block.Q, block.rank);
    }
    carried = run_stage(of, block, i, carried);
  }
  if (store != nullptr) store->finish(data, arena);
  judge.set_constraint_errors(max_abs(carried.block(0, (last_stage - 1) * data.n, error_rows, data.n)));
  const View rows = carried.block(error_rows, 0, carried.rows - error_rows, carried.cols);
  Carried result = split(rows, (last_stage - 1) * data.n, data.n, rhs.cols);
  result.rank_E = block.rank;
  result.R = block.factors;
  result.pivots = block.pivots;
  if (level == 0) {
    result.Q1 = block.Q.columns(0, block.rank);
    result.sign_of_Q = block.sign_of_Q;
  }
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
    for (int row = 0; row < m; ++row)
      for (int col = 0; col < array.cols() && !data.has_row(row, i); ++col) array(i * m + row, col) = 0.0;
  }
  return array;
}

Carried eliminate_by_svd(const TaylorData& data, int level, ConstView rhs, Judge& judge, Arena& arena) {
  const int n = data.n;
  const DiagonalBlock block = factor_diagonal_block(data, 0, judge, arena);
  const Matrix full = taylor_array(data, level);
  Matrix array = full, f((level + 1) * data.m, rhs.cols);
  int rows = 0;
  for (int i = 0; i <= level; ++i) {
    const int first = i * data.m, left = (level + 1) * data.m - rows;
    gather_rows(data, i, rhs.block(first, 0, data.m, rhs.cols), f.view().block(rows, 0, left, rhs.cols));
    rows += gather_rows(data, i, full.view().block(first, 0, data.m, full.cols()),
                        array.view().block(rows, 0, left, full.cols()));
  }
  const Svd decomposition = svd(array.view().block(0, 0, rows, (level + 1) * n));
  const int rank = judge.decide_array(decomposition.s, rows, (level + 1) * n);
  const ConstView Z = decomposition.U.view().columns(rank, rows - rank);
  const View carried = arena.matrix(rows - rank, n + rhs.cols);
  const ConstView N = array.view().block(0, (level + 1) * n, rows, n);
  multiply(1.0, Op::transposed, Z, Op::plain, N, 0.0, carried.columns(0, n));
  multiply(1.0, Op::transposed, Z, Op::plain, f.view().top(rows), 0.0, carried.columns(n, rhs.cols));
  Carried result = split(carried, 0, n, rhs.cols);
  result.rank_E = block.rank;
  result.R = block.factors;
  result.pivots = block.pivots;
  return result;
}

}  // namespace sfdae::core
