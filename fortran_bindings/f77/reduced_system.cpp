// The strangeness-free system at one point from stage mu of the derivative array.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/reduced_system.h"

#include <algorithm>
#include <vector>

#include "f77/orthogonal_factors.h"
#include "linalg/dense.h"

namespace sfdae::f77 {

using namespace core;

bool StageRanks::possible() const {
  return is_dimension(n) && is_dimension(rows) && rows >= n && d >= 0 && a >= 0 && u >= 0 && rank >= 0 &&
         rank <= rows && a <= kernel() && u <= kernel() - a && a <= n && d <= n - a && u <= n - a - d;
}

StageRanks ranks_of(const StageValues& values, int n) {
  const CharacteristicValues& found = values.characteristic;
  return {n, (found.mu + 1) * n, found.d, found.a, found.u, values.rank};
}

std::int64_t documented_work(const StageRanks& ranks) {
  const std::int64_t rows = ranks.rows;
  return 3 * std::int64_t{ranks.n} + 2 * rows + 2 * rows * rows;
}

namespace {

// [Z2 Z3] of the range of Z, orthonormal: Z3^T AQ = 0, Z2^T AQ of rank a.
//
// The two are told apart with rows of [EQ AQ] made comparable, D [EQ AQ]: else rounding errors of a redundant
// equation in small units would be larger than an equation in large ones. Z = D Z^ for null vectors Z^ of D EQ.
Matrix split_null_space(ConstView EQ, ConstView AQ, ConstView Z, int a) {
  const int kernel = Z.cols, redundant = kernel - a;
  const std::vector<double> D = row_factors(EQ, AQ);
  std::vector<double> inverse;
  for (double factor : D) inverse.push_back(1.0 / factor);
  const Matrix scaled = orthogonal_factor(scaled_rows(inverse, Z));
  const ConstView basis = scaled.view().columns(0, kernel);
  const Matrix Q = orthogonal_factor(transpose_product(basis, scaled_rows(D, AQ)));
  const Matrix Z3 = scaled_rows(D, product(basis, Q.view().columns(a, redundant)));
  const Matrix Z2 = scaled_rows(D, product(basis, Q.view().columns(0, a)));
  // Z3 keeps its range, Z2 becomes orthogonal to it.
  const Matrix of_Z3 = orthogonal_factor(Z3);
  const ConstView complement = of_Z3.view().columns(redundant, Z.rows - redundant);
  const Matrix of_Z2 = orthogonal_factor(transpose_product(complement, Z2));
  Matrix result(Z.rows, kernel);
  multiply(1.0, Op::plain, complement, Op::plain, of_Z2.view().columns(0, a), 0.0, result.view().columns(0, a));
  copy(of_Z3.view().columns(0, redundant), result.view().columns(a, redundant));
  return result;
}

}  // namespace

Transformations transformations(const StageRanks& ranks, ConstView EQ, ConstView AQ, ConstView Z) {
  const int n = ranks.n, a = ranks.a;
  if (ranks.kernel() == 0) return {};
  Transformations result{split_null_space(EQ, AQ, Z, a), {}};
  const Matrix A2 = transpose_product(result.Z.view().columns(0, a), AQ);
  const Matrix complement = orthogonal_factor(transpose(A2));
  const ConstView T2 = complement.view().columns(a, n - a);
  const Matrix range = orthogonal_factor(product(EQ.block(0, 0, n, n), T2));
  result.Z1 = to_matrix(range.view().columns(0, ranks.d));
  return result;
}

void store(const Transformations& found, const StageRanks& ranks, const Array& Z2Q, const Array& Z1) {
  if (ranks.kernel() == 0) {
    copy(identity(ranks.rows), Z2Q.view(ranks.rows, ranks.rows));
    copy(identity(ranks.n), Z1.view(ranks.n, ranks.n));
    return;
  }
  copy(found.Z, Z2Q.view(ranks.rows, ranks.kernel()));
  copy(found.Z1, Z1.view(ranks.n, ranks.d));
}

int reduce(const StageRanks& ranks, const StageData& stage, const ReducedSystem& reduced) {
  const int n = ranks.n, rows = ranks.rows, d = ranks.d, a = ranks.a, kernel = ranks.kernel();
  if (!ranks.possible() || !stage.EQ.holds(rows) || !stage.AQ.holds(rows) || !reduced.Z2Q.holds(rows) ||
      !reduced.Z1.holds(n) || !reduced.E.holds(n) || !reduced.A.holds(n))
    return argument_error;
  const ConstView EQ = stage.EQ.view(rows, rows), AQ = stage.AQ.view(rows, n);
  const View Z2Q = reduced.Z2Q.view(rows, rows);
  if (!is_finite(EQ) || !is_finite(AQ) || !is_finite(Z2Q)) return not_converged;
  const Matrix Z = to_matrix(Z2Q.columns(ranks.rank, kernel));
  const Transformations found = transformations(ranks, EQ, AQ, Z);
  if (!found.is_finite()) return not_converged;
  store(found, ranks, reduced.Z2Q, reduced.Z1);

  const View E = reduced.E.view(n, n), A = reduced.A.view(n, n), Z1 = reduced.Z1.view(n, d);
  fill(E, 0.0);
  fill(A, 0.0);
  multiply(1.0, Op::transposed, Z1, Op::plain, EQ.block(0, 0, n, n), 0.0, E.top(d));
  multiply(1.0, Op::transposed, Z1, Op::plain, AQ.top(n), 0.0, A.top(d));
  multiply(1.0, Op::transposed, Z2Q.columns(0, a), Op::plain, AQ, 0.0, A.block(d, 0, a, n));
  reduce_right_side(ranks, stage.FQ, reduced);
  return 0;
}

void reduce_right_side(const StageRanks& ranks, const double* FQ, const ReducedSystem& reduced) {
  const int n = ranks.n, d = ranks.d;
  std::fill_n(reduced.F, n, 0.0);
  multiply(1.0, Op::transposed, reduced.Z1.view(n, d), FQ, 0.0, reduced.F);
  multiply(1.0, Op::transposed, reduced.Z2Q.view(ranks.rows, ranks.a + ranks.u), FQ, 0.0, reduced.F + d);
}

}  // namespace sfdae::f77
