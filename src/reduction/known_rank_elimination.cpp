// Elimination of a matrix and of perturbed copies whose rank is known.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/known_rank_elimination.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "linalg/arena.h"
#include "linalg/dense.h"

namespace sfdae::core {

namespace {

constexpr int num_versions = LockstepMatrix::versions;
// Pivots that are taken one by one; products of matrices do the rest. Chosen.
constexpr int pivots_at_once = 8;
// Same constants as in lockstep_kernel.cpp: rounding errors of the elimination itself, and a guard of divisions.
constexpr double arithmetic = 0x1p-47, negligible = 1e-30, smallest_unit = 1e-300;

double ratio(double a, double b) { return a / std::max(b, negligible * a + smallest_unit); }

using Versions = std::array<Matrix, num_versions>;

// Row rows[i] and column columns[j] of the matrix are row i and column j here.
struct Order {
  std::vector<int> rows, columns;
};

// Place of a row among the blocks of a column, of the matrix itself.
struct RowPlace {
  std::size_t block, lane;
  explicit RowPlace(int row)
      : block(index(row) / index(lane_count) * index(num_versions)), lane(index(row) % index(lane_count)) {}
};

void read(const LockstepMatrix& from, int version, const Order& order, Matrix& to) {
  const std::vector<RowPlace> places(order.rows.begin(), order.rows.end());
  to = Matrix(from.rows(), from.cols());
  for (int j = 0; j < from.cols(); ++j) {
    const LaneBlock* blocks = from.column(order.columns[index(j)]) + version;
    double* column = to.view().column(j);
    for (const RowPlace& place : places) *column++ = blocks[place.block].lane[place.lane];
  }
}

// Rows stay where the elimination has put them, columns go back.
void write(const Matrix& from, int version, const Order& order, LockstepMatrix& to) {
  for (int j = 0; j < to.cols(); ++j) {
    LaneBlock* blocks = to.column(order.columns[index(j)]) + version;
    const double* column = from.view().column(j);
    for (int i = 0; i < to.rows(); ++i) blocks[i / lane_count * num_versions].lane[i % lane_count] = column[i];
  }
}

// Independent columns come first.
Order order_of_columns(const LockstepMatrix& matrix, int width) {
  Order order{std::vector<int>(index(matrix.rows())), std::vector<int>(index(matrix.cols()))};
  std::iota(order.rows.begin(), order.rows.end(), 0);
  std::iota(order.columns.begin(), order.columns.end(), 0);
  Matrix factors;
  read(matrix, 0, order, factors);
  Arena arena;
  double* tau = arena.take(index(std::min(matrix.rows(), width)) + 1);
  factor_qr_pivoted(factors.view().columns(0, width), order.columns.data(), tau, arena);
  return order;
}

void exchange_rows(View a, int i, int k) {
  for (int j = 0; j < a.cols && i != k; ++j) std::swap(a(i, j), a(k, j));
}

// The rows from `step` on in the columns [step, end), with the multipliers below the pivot.
void take_pivot(View a, int step, int end) {
  const double pivot = a(step, step);
  double* factors = a.column(step);
  for (int i = step + 1; i < a.rows; ++i) factors[i] /= pivot;
  for (int j = step + 1; j < end; ++j) {
    double* column = a.column(j);
    const double above = column[step];
    for (int i = step + 1; i < a.rows; ++i) column[i] -= factors[i] * above;
  }
}

// U in the rows [first, end) of the other columns, with L of the columns [first, end).
void solve_lower(View a, int first, int end, View beside) {
  const int count = end - first, middle = first + count / 2;
  if (count > pivots_at_once) {
    solve_lower(a, first, middle, beside);
    multiply(-1.0, Op::plain, a.block(middle, first, end - middle, middle - first), Op::plain,
             beside.block(first, 0, middle - first, beside.cols), 1.0,
             beside.block(middle, 0, end - middle, beside.cols));
    return solve_lower(a, middle, end, beside);
  }
  for (int j = 0; j < beside.cols; ++j)
    for (int step = first; step < end; ++step)
      for (int i = step + 1; i < end; ++i) beside(i, j) -= a(i, step) * beside(step, j);
}

// Applies pivots [first, end) to other columns.
void follow(View a, int first, int end, View beside) {
  solve_lower(a, first, end, beside);
  const int below = a.rows - end;
  multiply(-1.0, Op::plain, a.block(end, first, below, end - first), Op::plain,
           beside.block(first, 0, end - first, beside.cols), 1.0, beside.block(end, 0, below, beside.cols));
}

// A = L U in place in the columns [first, end), by recursive halving. rows: exchanged for the largest pivots, and their
// order on return; null: unchanged. False if a pivot vanishes.
bool factor_columns(View a, int first, int end, std::vector<int>* rows) {
  if (const int count = end - first; count > pivots_at_once) {
    const int middle = first + count / 2;
    if (!factor_columns(a, first, middle, rows)) return false;
    follow(a, first, middle, a.columns(middle, end - middle));
    return factor_columns(a, middle, end, rows);
  }
  for (int step = first; step < end; ++step) {
    int best = step;
    for (int i = step + 1; i < a.rows && rows != nullptr; ++i)
      if (std::fabs(a(i, step)) > std::fabs(a(best, step))) best = i;
    if (a(best, step) == 0.0) return false;
    exchange_rows(a, step, best);
    if (rows != nullptr) std::swap((*rows)[index(step)], (*rows)[index(best)]);
    take_pivot(a, step, end);
  }
  return true;
}

// With `rank` pivots, in all columns.
bool factor(View a, int rank, std::vector<int>* rows) {
  if (!factor_columns(a, 0, rank, rows)) return false;
  follow(a, 0, rank, a.columns(rank, a.cols - rank));
  return true;
}

// Sums of sizes of terms in the rows from `rank` on.
struct Sums {
  Matrix sizes;         // |A21| in columns with pivots, |A22| + |L21| |U12| in the others
  Matrix with_factors;  // of the others, |A22| + S_L S_U: with the sums for L and U themselves
};

Matrix absolute(ConstView a) {
  Matrix result = to_matrix(a);
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) result(i, j) = std::fabs(result(i, j));
  return result;
}

// S_L = (|A21| + |L21| |U11|) / |diag U11|, S_U = |A12| + |L11| |U12|, without the diagonals of L11 and U11.
Sums sums_of(const LockstepMatrix& matrix, const Order& order, ConstView factors, int rank) {
  const int left = matrix.rows() - rank, others = matrix.cols() - rank;
  Matrix all;
  read(matrix, 0, order, all);
  all = absolute(all);
  const ConstView A = all.view();
  Matrix S_L = to_matrix(A.block(rank, 0, left, rank)), S_U = to_matrix(A.block(0, rank, rank, others));
  const Matrix L21 = absolute(factors.block(rank, 0, left, rank)),
               U12 = absolute(factors.block(0, rank, rank, others));
  Matrix L11(rank, rank), U11(rank, rank);
  for (int j = 0; j < rank; ++j)
    for (int i = 0; i < rank; ++i) (i > j ? L11 : U11)(i, j) = i == j ? 0.0 : std::fabs(factors(i, j));
  multiply(1.0, Op::plain, L21, Op::plain, U11, 1.0, S_L);
  multiply(1.0, Op::plain, L11, Op::plain, U12, 1.0, S_U);
  for (int k = 0; k < rank; ++k)
    for (int i = 0; i < left; ++i) S_L(i, k) /= std::fabs(factors(k, k));
  Sums sums{to_matrix(A.block(rank, 0, left, matrix.cols())), to_matrix(A.block(rank, rank, left, others))};
  multiply(1.0, Op::plain, L21, Op::plain, U12, 1.0, sums.sizes.view().columns(rank, others));
  multiply(1.0, Op::plain, S_L, Op::plain, S_U, 1.0, sums.with_factors);
  return sums;
}

// Entry (i, j) with its copies.
struct Entry {
  double value, largest_move;
  Entry(const Versions& all, int i, int j) : value(std::fabs(all[0](i, j))), largest_move(0.0) {
    for (const Matrix& copy : all) largest_move = std::max(largest_move, std::fabs(copy(i, j) - all[0](i, j)));
  }
  double significance() const { return ratio(value, largest_move); }
};

// The rows without pivots.
class Remainder {
 public:
  Remainder(Versions& all, const Sums& sums, int rank, Significance& significance)
      : all_(all),
        sums_(sums),
        rank_(rank),
        rows_(sums.sizes.rows()),
        cols_(sums.sizes.cols()),
        significance_(significance) {}

  // Rounding errors left of sums become zero.
  void drop_rounding();
  // The columns [rank, end) count as zero, relative to the sums in the first `measured` columns.
  void drop_columns(int end, int measured);
  // Rows without any value in the columns from `first` on become zero.
  void drop_rows(int first);

 private:
  // Sums are as uncertain as their data, even where copies happen to agree.
  Entry entry(int i, int j) const {
    Entry found(all_, rank_ + i, j);
    found.largest_move = std::max(found.largest_move, trial_perturbation * sums_.with_factors(i, j - rank_));
    return found;
  }
  void drop(int i, int j, double largest_sum) {
    const Entry entry = this->entry(i, j);
    significance_.strongest = std::max(significance_.strongest, entry.significance());
    significance_.amplification =
        std::max(significance_.amplification, ratio(entry.largest_move, trial_perturbation * largest_sum));
  }
  std::vector<double> largest_sums(int columns) const;

  Versions& all_;
  const Sums& sums_;
  int rank_, rows_, cols_;
  Significance& significance_;
};

void Remainder::drop_rounding() {
  for (int j = rank_; j < cols_; ++j)
    for (int i = 0; i < rows_; ++i) {
      double most = 0.0;
      for (const Matrix& copy : all_) most = std::max(most, std::fabs(copy(rank_ + i, j)));
      if (most > arithmetic * sums_.sizes(i, j)) continue;
      for (Matrix& copy : all_) copy(rank_ + i, j) = 0.0;
    }
}

std::vector<double> Remainder::largest_sums(int columns) const {
  std::vector<double> largest(index(rows_), 0.0);
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i < rows_; ++i) largest[index(i)] = std::max(largest[index(i)], sums_.sizes(i, j));
  return largest;
}

void Remainder::drop_columns(int end, int measured) {
  const std::vector<double> largest = largest_sums(measured);
  for (int j = rank_; j < end; ++j)
    for (int i = 0; i < rows_; ++i) drop(i, j, largest[index(i)]);
}

void Remainder::drop_rows(int first) {
  const std::vector<double> largest = largest_sums(cols_);
  std::vector<char> has_values(index(rows_), 0);
  for (int j = first; j < cols_; ++j)
    for (int i = 0; i < rows_; ++i)
      if (has_values[index(i)] == 0 && entry(i, j).significance() >= 1.0) has_values[index(i)] = 1;
  for (int j = first; j < cols_; ++j)
    for (int i = 0; i < rows_; ++i) {
      if (has_values[index(i)] != 0) continue;
      drop(i, j, largest[index(i)]);
      for (Matrix& copy : all_) copy(rank_ + i, j) = 0.0;
    }
}

bool are_finite(const Versions& all) {
  return std::all_of(all.begin(), all.end(), [](const Matrix& copy) {
    return all_finite(copy.data(), index(copy.rows()) * index(copy.cols()));
  });
}

// Smallest q and size of the pivots; the multipliers below them are no longer needed.
void note_pivots(const LockstepMatrix& matrix, int width, int rank, Versions& all, Significance& significance) {
  double norm = 0.0;
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < matrix.rows(); ++i) norm = std::max(norm, std::fabs(matrix.at(i, j)));
  for (int k = 0; k < rank; ++k) {
    const Entry pivot(all, k, k);
    significance.weakest = std::min(significance.weakest, pivot.significance());
    significance.smallest_pivot = std::min(significance.smallest_pivot, pivot.value / norm);
    for (Matrix& copy : all) std::fill(copy.view().column(k) + k + 1, copy.view().column(k) + copy.rows(), 0.0);
  }
}

}  // namespace

void eliminate_with_rank(LockstepMatrix& matrix, int width, int rank, Significance& significance, ZeroScale scale) {
  if (rank > std::min(matrix.rows(), width)) {
    significance.weakest = 0.0;
    return;
  }
  if (matrix.rows() == 0) return;
  Order order = order_of_columns(matrix, width);
  Versions all;
  read(matrix, 0, order, all[0]);
  bool has_pivots = factor(all[0], rank, &order.rows);
  for (int k = 1; k < num_versions && has_pivots; ++k) {
    read(matrix, k, order, all[index(k)]);
    has_pivots = factor(all[index(k)], rank, nullptr);
  }
  if (!has_pivots || !are_finite(all)) {
    significance.weakest = 0.0;
    return;
  }
  const Sums sums = sums_of(matrix, order, all[0], rank);
  note_pivots(matrix, width, rank, all, significance);
  Remainder remainder(all, sums, rank, significance);
  remainder.drop_rounding();
  remainder.drop_columns(width, scale == ZeroScale::whole_rows ? matrix.cols() : width);
  remainder.drop_rows(width);
  for (int k = 0; k < num_versions; ++k) write(all[index(k)], k, order, matrix);
}

}  // namespace sfdae::core
