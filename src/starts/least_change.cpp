// The change of values that makes them consistent and moves the differential variables as little as possible.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/least_change.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/arena.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Orthonormal basis of the range of A and, if there are further columns, of its orthogonal complement.
Matrix orthonormal(ConstView A, int columns) {
  Arena arena;
  Matrix factors = to_matrix(A), basis(A.rows, columns);
  Vector tau(index(std::min(A.rows, A.cols)) + 1);
  factor_qr(factors, tau.data(), arena);
  form_q(factors, std::min(A.rows, A.cols), tau.data(), basis, arena);
  return basis;
}

// x of least |A x - b|, A of full column rank.
Vector least_squares_of_full_rank(Matrix A, Matrix b) {
  const int columns = A.cols();
  Arena arena;
  Vector tau(index(columns) + 1);
  factor_qr(A, tau.data(), arena);
  apply_q(Op::transposed, A, columns, tau.data(), b, arena);
  solve_upper(Op::plain, A.view().top(columns), b.view().top(columns));
  return {b.data(), b.data() + columns};
}

// x of least 2-norm with A x = b, A of full row rank.
Vector least_norm(const Matrix& A, const Vector& b) {
  const int rows = A.rows(), columns = A.cols();
  Vector x(index(columns), 0.0);
  if (rows == 0) return x;
  Arena arena;
  Matrix factors = transpose(A), solution(columns, 1);
  Vector tau(index(rows) + 1);
  factor_qr(factors, tau.data(), arena);
  std::copy_n(b.begin(), rows, solution.data());
  solve_upper(Op::transposed, factors.view().top(rows), solution.view().top(rows));
  apply_q(Op::plain, factors, rows, tau.data(), solution, arena);
  std::copy_n(solution.data(), columns, x.begin());
  return x;
}

Matrix with_scaled_columns(ConstView A, const Vector& factors) {
  Matrix scaled = to_matrix(A);
  for (int j = 0; j < A.cols; ++j)
    for (int i = 0; i < A.rows; ++i) scaled(i, j) *= factors[index(j)];
  return scaled;
}

Matrix with_rows_divided(ConstView A, const Vector& sizes) {
  Matrix divided = to_matrix(A);
  for (int j = 0; j < A.cols; ++j)
    for (int i = 0; i < A.rows; ++i) divided(i, j) /= sizes[index(i)];
  return divided;
}

// The constraints G dx = g, first those that the kernel can satisfy: `rank` of them, R1 in the columns `order`.
struct SplitConstraints {
  Matrix G;
  Vector g;
  Matrix R;  // of G K
  std::vector<int> order;
  int rank = 0;
};

SplitConstraints split(const ConsistentSet& set, const LeadingKernel& kernel, const ChangeMeasure& measure,
                       const double* x) {
  const int n = set.directions.rows, free = set.directions.cols, count = n - free, k = kernel.basis.cols();
  Arena arena;
  const Matrix all = orthonormal(set.directions, n);
  const ConstView Q = all.view().columns(free, count);
  SplitConstraints result;
  result.R = transpose_product(Q, kernel.basis);
  result.order.resize(index(k) + 1);
  Vector tau(index(std::min(count, k)) + 1), missing(set.base, set.base + n);
  factor_qr_pivoted(result.R, result.order.data(), tau.data(), arena);
  const auto is_fulfilled = [&](int j) {
    return std::fabs(result.R(j, j)) > (j < measure.least_fulfilled ? 0.0 : measure.noise);
  };
  while (result.rank < std::min(count, k) && is_fulfilled(result.rank)) ++result.rank;
  for (int i = 0; i < n; ++i) missing[index(i)] -= x[i];
  result.G = transpose(Q);
  Matrix right(count, 1);
  multiply(1.0, Op::plain, result.G, missing.data(), 0.0, right.data());
  apply_q(Op::transposed, result.R, std::min(count, k), tau.data(), result.G, arena);
  apply_q(Op::transposed, result.R, std::min(count, k), tau.data(), right, arena);
  result.g.assign(right.data(), right.data() + count);
  return result;
}

// Satisfies constraints that the kernel cannot, by the least change in the norm of the sizes.
Vector change_of_differentiated(const SplitConstraints& constraints, const LeadingKernel& kernel,
                                const Vector& sizes) {
  const int n = constraints.G.cols(), first = constraints.rank, count = constraints.G.rows() - first;
  Matrix B = to_matrix(constraints.G.view().block(first, 0, count, n));
  // B K = 0 except for rounding errors, which different sizes would magnify.
  const Matrix BK = product(B, kernel.basis);
  multiply(-1.0, Op::plain, BK, Op::transposed, kernel.basis, 1.0, B);
  Vector dx = least_norm(with_scaled_columns(B, sizes), Vector(constraints.g.begin() + first, constraints.g.end()));
  for (std::size_t i = 0; i < dx.size(); ++i) dx[i] *= sizes[i];
  return dx;
}

// Adds to dx the least change K c such that R1 c is the remainder of the other constraints.
void add_change_of_kernel(const SplitConstraints& constraints, const LeadingKernel& kernel, const Vector& sizes,
                          Vector& dx) {
  const int rank = constraints.rank, k = kernel.basis.cols();
  if (rank == 0) return;
  Matrix solution(k, k - rank + 1);  // [a solution | those without a right-hand side], ordered as R is
  const View top = solution.view().top(rank);
  std::copy_n(constraints.g.begin(), rank, solution.data());
  multiply(-1.0, Op::plain, constraints.G.view().top(rank), dx.data(), 1.0, solution.data());
  for (int j = 0; j < k - rank; ++j) {
    for (int i = 0; i < rank; ++i) top(i, j + 1) = -constraints.R(i, rank + j);
    solution(rank + j, j + 1) = 1.0;
  }
  solve_upper(Op::plain, constraints.R.view().block(0, 0, rank, rank), top);
  Matrix c(k, k - rank + 1);
  for (int j = 0; j < c.cols(); ++j)
    for (int i = 0; i < k; ++i) c(constraints.order[index(i)], j) = solution(i, j);
  const Matrix Kc = product(kernel.basis, c);
  Vector change(Kc.data(), Kc.data() + Kc.rows());
  if (k > rank) {
    const Matrix open = to_matrix(Kc.view().columns(1, k - rank)), measured = with_rows_divided(open, sizes);
    Vector target(change);
    for (std::size_t i = 0; i < target.size(); ++i) target[i] /= -sizes[i];
    const Vector shares = least_squares(measured, target, 0.0);
    multiply(1.0, Op::plain, open, shares.data(), 1.0, change.data());
  }
  for (std::size_t i = 0; i < dx.size(); ++i) dx[i] += change[i];
}

}  // namespace

LeadingKernel::LeadingKernel(ConstView E, int rank, ConstView known) {
  const int n = E.cols;
  std::vector<int> with_derivative, without;
  for (int j = 0; j < n; ++j) (max_abs(E.column(j), E.rows) > 0.0 ? with_derivative : without).push_back(j);
  const int count = static_cast<int>(with_derivative.size());
  rank = std::min({rank, count, E.rows});
  num_unit_vectors = static_cast<int>(without.size());
  if (count == n && known.cols > 0 && known.cols == n - rank) {
    basis = to_matrix(known);
    return;
  }
  basis = Matrix(n, n - rank);
  for (int j = 0; j < num_unit_vectors; ++j) basis(without[index(j)], j) = 1.0;
  if (rank == count) return;
  // [-R11^-1 R12; I], orthonormalized.
  Arena arena;
  Matrix part(E.rows, count), combinations(count, count - rank);
  for (int j = 0; j < count; ++j) copy(E.columns(with_derivative[index(j)], 1), part.view().columns(j, 1));
  Vector tau(index(std::min(E.rows, count)) + 1);
  std::vector<int> pivots(index(count) + 1);
  factor_qr_pivoted(part, pivots.data(), tau.data(), arena);
  const View top = combinations.view().top(rank);
  copy(part.view().block(0, rank, rank, count - rank), top);
  solve_upper(Op::plain, part.view().block(0, 0, rank, rank), top);
  for (int j = 0; j < count - rank; ++j) {
    for (int i = 0; i < rank; ++i) top(i, j) = -top(i, j);
    combinations(rank + j, j) = 1.0;
  }
  const Matrix kernel = orthonormal(combinations, count - rank);
  for (int j = 0; j < count - rank; ++j)
    for (int i = 0; i < count; ++i)
      basis(with_derivative[index(pivots[index(i)])], num_unit_vectors + j) = kernel(i, j);
}

double error_of_directions(int n, double kept) { return n * unit_roundoff / std::max(kept, 1e-300); }

double least_cosine(int n, double kept) {
  // Three digits of room above the errors; at least what the user's own arithmetic leaves of zeros, at most what nobody
  // takes for one (docs/design/consistent_initialization.md).
  constexpr double room = 1e3, least = 1e-12, most = 1e-6;
  return std::clamp(room * error_of_directions(n, kept), least, most);
}

Vector least_change(const ConsistentSet& set, const LeadingKernel& kernel, const ChangeMeasure& measure,
                    const double* x) {
  const SplitConstraints constraints = split(set, kernel, measure, x);
  Vector dx = change_of_differentiated(constraints, kernel, measure.sizes);
  add_change_of_kernel(constraints, kernel, measure.sizes, dx);
  return dx;
}

double size_in_constraints(const ConsistentSet& set, int i, const double* x) {
  const ConstView& T2 = set.directions;
  double sum = 0.0;
  for (int j = 0; j < T2.rows; ++j) {
    double entry = j == i ? 1.0 : 0.0;
    for (int k = 0; k < T2.cols; ++k) entry -= T2(i, k) * T2(j, k);
    sum += std::fabs(entry * x[j]);
  }
  return sum;
}

// dx - K (K^T D^-2 K)^-1 K^T D^-2 dx; for unit vectors that is dx without their components, exactly.
Vector differentiated_part(const LeadingKernel& kernel, const Vector& sizes, const Vector& dx) {
  const int n = kernel.basis.rows(), k = kernel.basis.cols();
  Vector part(dx);
  if (kernel.is_coordinates()) {
    for (int j = 0; j < k; ++j)
      for (int i = 0; i < n; ++i)
        if (kernel.basis(i, j) != 0.0) part[index(i)] = 0.0;
    return part;
  }
  Matrix target(n, 1);
  for (int i = 0; i < n; ++i) target(i, 0) = dx[index(i)] / sizes[index(i)];
  const Vector shares = least_squares_of_full_rank(with_rows_divided(kernel.basis, sizes), std::move(target));
  multiply(-1.0, Op::plain, kernel.basis, shares.data(), 1.0, part.data());
  return part;
}

}  // namespace sfdae::core
