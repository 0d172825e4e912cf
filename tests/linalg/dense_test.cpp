// SPDX-License-Identifier: BSD-3-Clause
// Every dense kernel against its defining property, on both sides of the switch from small loops to LAPACK.
#include "linalg/dense.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <vector>

#include "matrix_checks.h"

namespace sfdae::core {

namespace {

using sfdae_test::column;
using sfdae_test::distance;
using sfdae_test::largest;
using sfdae_test::orthonormality_defect;
using sfdae_test::outside_range;
using sfdae_test::random_matrix;
using sfdae_test::random_vector;
using sfdae_test::rounding;
using sfdae_test::size;
using sfdae_test::times;
using sfdae_test::transposed;

struct Shape {
  int rows, cols;
};

// Around the crossovers at 16, 24 and 48, and far from square.
constexpr Shape shapes[] = {{1, 1},   {2, 2},   {1, 5},   {5, 1},   {3, 2},   {2, 3},   {16, 16},
                            {17, 17}, {24, 24}, {25, 25}, {40, 40}, {48, 24}, {49, 24}, {24, 49},
                            {25, 48}, {10, 70}, {70, 10}, {70, 70}, {0, 3},   {3, 0},   {0, 0}};

// A matrix inside a larger array whose other entries must not change.
class Guarded {
 public:
  explicit Guarded(ConstView a)
      : entries_(size(a.rows + 3) * size(a.cols + 1) + 1, guard),
        view{entries_.data() + 1, a.rows, a.cols, a.rows + 3} {
    copy(a, view);
  }
  bool guards_intact() const {
    std::vector<bool> inside(entries_.size(), false);
    for (int j = 0; j < view.cols; ++j)
      for (int i = 0; i < view.rows; ++i) inside[size(1 + i + j * view.ld)] = true;
    for (std::size_t k = 0; k < entries_.size(); ++k)
      if (!inside[k] && entries_[k] != guard) return false;
    return true;
  }

 private:
  static constexpr double guard = 12345.0;
  std::vector<double> entries_;

 public:
  View view;
};

Matrix upper_triangle(ConstView a) {
  Matrix r(std::min(a.rows, a.cols), a.cols);
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i <= std::min(j, r.rows() - 1); ++i) r(i, j) = a(i, j);
  return r;
}

Matrix op(Op which, ConstView a) { return which == Op::plain ? to_matrix(a) : transposed(a); }

// Rank r, singular values between 1 and about rows cols.
Matrix matrix_of_rank(int rows, int cols, int rank, std::uint64_t seed) {
  return times(random_matrix(rows, rank, seed), random_matrix(rank, cols, seed + 1));
}

// Upper triangular with a diagonal of size 1..2 and small entries above: well conditioned.
Matrix well_conditioned_upper(int order, std::uint64_t seed) {
  Matrix r = random_matrix(order, order, seed);
  for (int j = 0; j < order; ++j)
    for (int i = 0; i < order; ++i) r(i, j) = i == j ? 1.5 + 0.5 * r(i, j) : i < j ? r(i, j) / order : 777.0;
  return r;
}

// B diag(...) B^-1 with blocks of complex eigenvalues 2 (cos phi +- i sin phi) at the end; two equal ones among the
// real.
TEST(NegativeEigenvalues, AreCountedIfTheyAreReal) {
  const std::vector<double> real = {-3.0, 2.0, -0.5, -0.5, 1e-3, 4.0};
  const int n = 10;
  Matrix D(n, n);
  for (int k = 0; k < 6; ++k) D(k, k) = real[size(k)];
  for (int k = 6; k < n; k += 2) {
    const double phi = k == 6 ? 3.0 : 1.0;
    D(k, k) = D(k + 1, k + 1) = 2.0 * std::cos(phi);
    D(k, k + 1) = 2.0 * std::sin(phi);
    D(k + 1, k) = -D(k, k + 1);
  }
  const Svd basis = svd(random_matrix(n, n, 5));
  Matrix A = product(product(basis.U, D), transpose(basis.U));
  Arena arena;
  EXPECT_EQ(count_negative_eigenvalues(A, arena), 3);
  Matrix empty;
  EXPECT_EQ(count_negative_eigenvalues(empty, arena), 0);
}

}  // namespace

// ---- Products ----

TEST(Multiply, AgreesWithPlainSumsForEveryOperationAndSize) {
  struct Sizes {
    int rows, cols, inner;
  };
  for (const Sizes s : {Sizes{1, 1, 1},
                        {3, 2, 4},
                        {4, 5, 7},
                        {11, 12, 13},
                        {12, 12, 12},
                        {13, 12, 12},
                        {40, 25, 17},
                        {70, 3, 70},
                        {3, 70, 40},
                        {0, 3, 2},
                        {3, 0, 2},
                        {3, 2, 0},
                        {40, 40, 0}})
    for (Op op_a : {Op::plain, Op::transposed})
      for (Op op_b : {Op::plain, Op::transposed})
        for (double alpha : {1.0, -0.75, 0.0})
          for (double beta : {0.0, 1.0, -2.5}) {
            const Matrix a =
                op_a == Op::plain ? random_matrix(s.rows, s.inner, 1) : random_matrix(s.inner, s.rows, 1);
            const Matrix b =
                op_b == Op::plain ? random_matrix(s.inner, s.cols, 2) : random_matrix(s.cols, s.inner, 2);
            const Matrix c = random_matrix(s.rows, s.cols, 3);
            const Guarded in_a(a), in_b(b);
            Guarded result(c);
            multiply(alpha, op_a, in_a.view, op_b, in_b.view, beta, result.view);
            const Matrix expected = sfdae_test::sum(alpha, times(op(op_a, a), op(op_b, b)), beta, c);
            EXPECT_LE(distance(result.view, expected), rounding(s.inner + 2) * 4.0)
                << s.rows << " x " << s.cols << ", inner " << s.inner;
            EXPECT_TRUE(result.guards_intact());
          }
}

// beta = 0 overwrites: what C held before, even NaN, does not matter.
TEST(Multiply, WithBetaZeroIgnoresTheOldResult) {
  for (int n : {3, 40}) {
    const Matrix a = random_matrix(n, n, 1), b = random_matrix(n, n, 2);
    for (Op op_a : {Op::plain, Op::transposed}) {
      Matrix c(n, n);
      fill(c, std::nan(""));
      multiply(1.0, op_a, a, Op::plain, b, 0.0, c);
      EXPECT_LE(distance(c, times(op(op_a, a), b)), rounding(n));
      std::vector<double> y(size(n), std::nan(""));
      multiply(1.0, op_a, a, b.data(), 0.0, y.data());
      EXPECT_LE(distance(column(y), c.view().columns(0, 1)), rounding(n));
    }
  }
}

TEST(Multiply, MatrixTimesVectorAgreesWithPlainSums) {
  for (const Shape s :
       {Shape{1, 1}, {5, 3}, {3, 5}, {32, 32}, {33, 32}, {70, 16}, {16, 70}, {70, 70}, {0, 4}, {4, 0}})
    for (Op which : {Op::plain, Op::transposed})
      for (double beta : {0.0, 1.0, -2.0}) {
        const Matrix a = random_matrix(s.rows, s.cols, 4);
        const Guarded in(a);
        const Matrix turned = op(which, a);
        const std::vector<double> x = random_vector(turned.cols(), 5), before = random_vector(turned.rows(), 6);
        std::vector<double> y = before;
        multiply(-1.25, which, in.view, x.data(), beta, y.data());
        const Matrix expected = sfdae_test::sum(-1.25, times(turned, column(x)), beta, column(before));
        EXPECT_LE(distance(column(y), expected), rounding(turned.cols() + 2) * 4.0) << s.rows << " x " << s.cols;
      }
}

TEST(Multiply, ProductsAllocateTheirResult) {
  const Matrix a = random_matrix(30, 20, 1), b = random_matrix(20, 25, 2), c = random_matrix(30, 7, 3);
  EXPECT_LE(distance(product(a, b), times(a, b)), rounding(20));
  EXPECT_LE(distance(transpose_product(a, c), times(transposed(a), c)), rounding(30));
}

// ---- Orthogonal factorizations ----

TEST(FactorQr, ProductOfItsFactorsIsTheMatrix) {
  Arena arena;
  for (const Shape s : shapes) {
    const Matrix a = random_matrix(s.rows, s.cols, 7);
    Guarded factors(a);
    const int count = std::min(s.rows, s.cols);
    std::vector<double> tau(size(count) + 1);
    factor_qr(factors.view, tau.data(), arena);
    EXPECT_TRUE(factors.guards_intact());
    Matrix q(s.rows, count);
    form_q(factors.view, count, tau.data(), q, arena);
    EXPECT_LE(orthonormality_defect(q), rounding(s.rows)) << s.rows << " x " << s.cols;
    EXPECT_LE(distance(times(q, upper_triangle(factors.view)), a), rounding(s.rows)) << s.rows << " x " << s.cols;
  }
}

TEST(FactorQrPivoted, ProductOfItsFactorsIsTheMatrixWithColumnsPermuted) {
  Arena arena;
  for (const Shape s : shapes) {
    const Matrix a = random_matrix(s.rows, s.cols, 8);
    Guarded factors(a);
    const int count = std::min(s.rows, s.cols);
    std::vector<double> tau(size(count) + 1);
    std::vector<int> pivots(size(s.cols) + 1, -1);
    factor_qr_pivoted(factors.view, pivots.data(), tau.data(), arena);
    EXPECT_TRUE(factors.guards_intact());
    Matrix q(s.rows, count), permuted(s.rows, s.cols);
    form_q(factors.view, count, tau.data(), q, arena);
    std::vector<int> sorted(pivots.begin(), pivots.end() - 1);
    std::sort(sorted.begin(), sorted.end());
    for (int j = 0; j < s.cols; ++j) ASSERT_EQ(sorted[size(j)], j) << "pivots are a permutation";
    for (int j = 0; j < s.cols; ++j) copy(a.view().columns(pivots[size(j)], 1), permuted.view().columns(j, 1));
    EXPECT_LE(distance(times(q, upper_triangle(factors.view)), permuted), rounding(s.rows))
        << s.rows << " x " << s.cols;
  }
}

// The pivot rule: |r_kk| is at least the length of the rest of every column behind it.
TEST(FactorQrPivoted, EveryPivotIsTheLongestColumnLeft) {
  Arena arena;
  for (const Shape s : shapes) {
    Matrix factors = random_matrix(s.rows, s.cols, 9);
    const double scale = largest(factors);
    std::vector<double> tau(size(s.cols) + 1);
    std::vector<int> pivots(size(s.cols) + 1);
    factor_qr_pivoted(factors, pivots.data(), tau.data(), arena);
    for (int k = 0; k < std::min(s.rows, s.cols); ++k)
      for (int j = k + 1; j < s.cols; ++j) {
        double squares = 0.0;
        for (int i = k; i <= std::min(j, s.rows - 1); ++i) squares += factors(i, j) * factors(i, j);
        EXPECT_GE(std::fabs(factors(k, k)) + rounding(s.rows) * scale, std::sqrt(squares)) << k << ", " << j;
      }
  }
}

TEST(FactorQrPivoted, RevealsTheRankOfDeficientMatrices) {
  Arena arena;
  for (const Shape s : shapes)
    for (int rank : {0, 1, std::min(s.rows, s.cols) / 2, std::min(s.rows, s.cols) - 1}) {
      if (rank < 0 || rank > std::min(s.rows, s.cols)) continue;
      const Matrix a = matrix_of_rank(s.rows, s.cols, rank, 10);
      Matrix factors = to_matrix(a);
      std::vector<double> tau(size(s.cols) + 1);
      std::vector<int> pivots(size(s.cols) + 1);
      factor_qr_pivoted(factors, pivots.data(), tau.data(), arena);
      const double scale = largest(a);
      for (int k = 0; k < std::min(s.rows, s.cols); ++k) {
        if (k < rank) EXPECT_GT(std::fabs(factors(k, k)), 1e-6 * scale);
        else EXPECT_LE(std::fabs(factors(k, k)), rounding(s.rows + s.cols) * scale);
      }
      // The first `rank` columns of Q span the range of A, as those of rank-deficient T2 and Z1 have to.
      Matrix q(s.rows, rank);
      form_q(factors, rank, tau.data(), q, arena);
      EXPECT_LE(outside_range(q, a), rounding(s.rows + s.cols) * scale);
    }
}

// Cancellation: columns that agree to 1e-9 lose all digits of their squared norms in the first step. A pivot rule
// that trusts updated norms picks wrong columns then.
TEST(FactorQrPivoted, RecomputesNormsThatCancellationHasEaten) {
  Arena arena;
  for (int n : {6, 24, 30}) {
    Matrix a(n, n);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) a(i, j) = 1.0;
    // Column j deviates by 1e-9 (j + 1) in row j alone: the longer deviation has to be taken first.
    for (int j = 0; j < n; ++j) a(j, j) += 1e-9 * (j + 1);
    Matrix factors = to_matrix(a);
    std::vector<double> tau(size(n) + 1);
    std::vector<int> pivots(size(n) + 1);
    factor_qr_pivoted(factors, pivots.data(), tau.data(), arena);
    for (int k = 1; k + 1 < n; ++k) {
      double squares = 0.0;
      for (int i = k; i <= k + 1; ++i) squares += factors(i, k + 1) * factors(i, k + 1);
      // The deviations are known to rounding / 1e-9.
      EXPECT_GE(std::fabs(factors(k, k)) * (1.0 + rounding(n) / 1e-9), std::sqrt(squares)) << n << ", " << k;
    }
  }
}

// x = (1, 1e-9): 1 - |x| vanishes by rounding, 1 + |x| does not.
TEST(FactorQr, LosesNoDigitsWhereColumnsAreNearlyTriangular) {
  Arena arena;
  for (double sign : {1.0, -1.0})
    for (int n : {2, 6, 30}) {
      Matrix a(n, n);
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) a(i, j) = i == j ? sign : 1e-9;
      Matrix factors = to_matrix(a), q(n, n);
      std::vector<double> tau(size(n));
      factor_qr(factors, tau.data(), arena);
      form_q(factors, n, tau.data(), q, arena);
      EXPECT_LE(orthonormality_defect(q), rounding(n));
      EXPECT_LE(distance(times(q, upper_triangle(factors)), a), rounding(n));
    }
}

// Householder reflections know no unit: a power of two as a factor changes no digit. 2^-400 squares to 1e-241.
TEST(FactorQrPivoted, IsInvariantUnderScaling) {
  Arena arena;
  for (double factor : {std::ldexp(1.0, -400), std::ldexp(1.0, 400)}) {
    const int n = 7;
    Matrix plain = random_matrix(n, n, 11), scaled = to_matrix(plain);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) scaled(i, j) *= factor;
    std::vector<double> tau(size(n)), scaled_tau(size(n));
    std::vector<int> pivots(size(n)), scaled_pivots(size(n));
    factor_qr_pivoted(plain, pivots.data(), tau.data(), arena);
    factor_qr_pivoted(scaled, scaled_pivots.data(), scaled_tau.data(), arena);
    EXPECT_EQ(pivots, scaled_pivots);
    EXPECT_EQ(tau, scaled_tau);
    for (int k = 0; k < n; ++k) EXPECT_EQ(scaled(k, k), factor * plain(k, k));
  }
}

TEST(ApplyQ, PlainAndTransposedAreInverseAndAgreeWithTheFormedQ) {
  Arena arena;
  for (const Shape s : {Shape{1, 1}, {5, 3}, {24, 24}, {48, 24}, {49, 24}, {40, 30}, {70, 25}, {70, 70}})
    for (int columns : {1, 2, 30}) {
      Matrix factors = random_matrix(s.rows, s.cols, 12);
      const int count = std::min(s.rows, s.cols);
      std::vector<double> tau(size(count));
      factor_qr(factors, tau.data(), arena);
      Matrix q(s.rows, s.rows);
      form_q(factors, count, tau.data(), q, arena);
      ASSERT_LE(orthonormality_defect(q), rounding(s.rows));
      const Matrix c = random_matrix(s.rows, columns, 13);
      Guarded result(c);
      apply_q(Op::transposed, factors, count, tau.data(), result.view, arena);
      EXPECT_LE(distance(result.view, times(transposed(q), c)), rounding(s.rows)) << s.rows << " x " << s.cols;
      apply_q(Op::plain, factors, count, tau.data(), result.view, arena);
      EXPECT_LE(distance(result.view, c), rounding(s.rows)) << s.rows << " x " << s.cols;
      EXPECT_TRUE(result.guards_intact());
    }
}

TEST(ApplyQ, WithFewerReflectionsLeavesTheRowsThatTheyDoNotReach) {
  Arena arena;
  for (const Shape s : {Shape{8, 6}, {60, 50}}) {
    Matrix factors = random_matrix(s.rows, s.cols, 14);
    std::vector<double> tau(size(s.cols));
    factor_qr(factors, tau.data(), arena);
    const int count = s.cols / 2;
    // Q_1 ... Q_count from the vectors alone: I - tau v v^T one after the other.
    Matrix expected = random_matrix(s.rows, 3, 15);
    Matrix c = to_matrix(expected);
    for (int p = 0; p < count; ++p)
      for (int j = 0; j < 3; ++j) {
        double inner = expected(p, j);
        for (int i = p + 1; i < s.rows; ++i) inner += factors(i, p) * expected(i, j);
        expected(p, j) -= tau[size(p)] * inner;
        for (int i = p + 1; i < s.rows; ++i) expected(i, j) -= tau[size(p)] * inner * factors(i, p);
      }
    apply_q(Op::transposed, factors, count, tau.data(), c, arena);
    EXPECT_LE(distance(c, expected), rounding(s.rows));
  }
}

// Q beyond the columns of A completes it to an orthogonal matrix: null spaces are read off there.
TEST(FormQ, CompletesToAnOrthogonalMatrix) {
  Arena arena;
  for (const Shape s : {Shape{5, 0}, {5, 2}, {24, 10}, {48, 24}, {49, 20}, {70, 25}, {70, 0}, {30, 30}}) {
    Matrix a = random_matrix(s.rows, s.cols, 16), factors = to_matrix(a);
    std::vector<double> tau(size(s.cols) + 1);
    factor_qr(factors, tau.data(), arena);
    Guarded q(Matrix(s.rows, s.rows));
    form_q(factors, s.cols, tau.data(), q.view, arena);
    EXPECT_TRUE(q.guards_intact());
    EXPECT_LE(orthonormality_defect(q.view), rounding(s.rows)) << s.rows << ", " << s.cols;
    const ConstView complement = q.view.columns(s.cols, s.rows - s.cols);
    EXPECT_LE(largest(times(transposed(complement), a)), rounding(s.rows)) << s.rows << ", " << s.cols;
  }
}

// ---- Triangular and linear systems ----

TEST(SolveUpper, ResidualsVanishAndTheLowerTriangleIsNotRead) {
  for (int order : {0, 1, 2, 16, 17, 24, 25, 40, 70})
    for (int columns : {0, 1, 2, 20}) {
      const Matrix r = well_conditioned_upper(order, 17);
      const Guarded in(r);
      Matrix clean = upper_triangle(r);
      const Matrix b = random_matrix(order, columns, 18);
      for (Op which : {Op::plain, Op::transposed}) {
        Guarded x(b);
        solve_upper(which, in.view, x.view);
        EXPECT_LE(distance(times(op(which, clean), x.view), b), rounding(order)) << order << ", " << columns;
        EXPECT_TRUE(x.guards_intact());
      }
      Guarded x(random_matrix(columns, order, 19));
      const Matrix before = to_matrix(x.view);
      solve_upper_right(in.view, x.view);
      EXPECT_LE(distance(times(x.view, clean), before), rounding(order)) << order << ", " << columns;
      EXPECT_TRUE(x.guards_intact());
    }
}

// The right-hand side may be longer than the triangle: rows behind it are not touched.
TEST(SolveUpper, LeavesRowsBehindTheTriangleAlone) {
  for (int order : {3, 20}) {
    Matrix b = random_matrix(order + 2, 4, 20);
    const Matrix before = to_matrix(b);
    solve_upper(Op::plain, well_conditioned_upper(order, 21), b);
    EXPECT_EQ(distance(b.view().block(order, 0, 2, 4), before.view().block(order, 0, 2, 4)), 0.0);
  }
}

TEST(FactorLu, SolvesWithSmallBackwardError) {
  for (int order : {1, 2, 3, 15, 16, 17, 24, 25, 40, 70}) {
    const Matrix a = random_matrix(order, order, 22);
    Guarded lu(a);
    std::vector<int> pivots(size(order));
    ASSERT_TRUE(factor_lu(lu.view, pivots.data()));
    EXPECT_TRUE(lu.guards_intact());
    const std::vector<double> b = random_vector(order, 23);
    std::vector<double> x = b;
    solve_lu(lu.view, pivots.data(), x.data());
    // Partial pivoting: residuals are small relative to |A| |x| even for large |x|.
    EXPECT_LE(distance(times(a, x.data()), b), rounding(order) * (largest(a) * largest(x) * order + largest(b)));
  }
}

// A X = B and A^T X = B for several columns together.
TEST(FactorLu, SolvesForSeveralColumnsAndForTheTranspose) {
  for (int order : {1, 2, 3, 15, 16, 17, 40})
    for (int columns : {0, 1, 4}) {
      const Matrix a = random_matrix(order, order, 22), b = random_matrix(order, columns, 24);
      Matrix lu = a;
      std::vector<int> pivots(size(order));
      ASSERT_TRUE(factor_lu(lu, pivots.data()));
      Guarded x(b), y(b);
      solve_lu(lu, pivots.data(), x.view);
      solve_lu_transposed(lu, pivots.data(), y.view);
      EXPECT_TRUE(x.guards_intact());
      EXPECT_TRUE(y.guards_intact());
      const double size_x = std::max(largest(x.view), largest(y.view));
      const double bound = rounding(order) * order * (largest(a) * size_x + largest(b));
      EXPECT_LE(distance(times(a, x.view), b), bound) << order;
      EXPECT_LE(distance(times(transpose(a), y.view), b), bound) << order;
    }
}

// A^-1 A = I; the sign is that of det A, and a pivot that vanishes is reported.
TEST(InvertSmall, IsTheInverseWithTheSignOfTheDeterminant) {
  Arena arena;
  for (int order : {1, 2, 3, 6, 16}) {
    Matrix a = random_matrix(order, order, 25);
    for (int i = 0; i < order; ++i) a(i, (i + 1) % order) += i % 2 == 0 ? 4.0 : -4.0;
    Matrix inverse = a, work = a;
    std::vector<double> pivots(size(order));
    int sign = 0;
    ASSERT_TRUE(invert_small(inverse, pivots.data(), sign));
    EXPECT_EQ(sign, determinant_sign(work, arena));
    Matrix defect = product(inverse, a);
    for (int i = 0; i < order; ++i) defect(i, i) -= 1.0;
    EXPECT_LE(max_abs(defect), 10.0 * rounding(order)) << order;
    Matrix singular(order, order);
    EXPECT_FALSE(invert_small(singular, pivots.data(), sign));
  }
}

// Without exchange of rows the first pivot is 1e-20 and all digits are lost: x = (1, 1) up to 1e-20.
TEST(FactorLu, ExchangesRowsForTheLargestPivot) {
  for (int order : {2, 20}) {
    Matrix a = identity(order);
    a(0, 0) = 1e-20;
    a(0, 1) = a(1, 0) = a(1, 1) = 1.0;
    std::vector<double> x(size(order), 1.0);
    x[1] = 2.0;
    std::vector<int> pivots(size(order));
    ASSERT_TRUE(factor_lu(a, pivots.data()));
    solve_lu(a, pivots.data(), x.data());
    for (double value : x) EXPECT_NEAR(value, 1.0, rounding(order));
  }
}

TEST(FactorLu, ReportsAPivotThatVanishesFirstInTheMiddleOrLast) {
  for (int order : {1, 2, 3, 16, 17, 40})
    for (int zero : {0, order / 2, order - 1}) {
      Matrix a = identity(order);
      a(zero, zero) = 0.0;
      std::vector<int> pivots(size(order));
      EXPECT_FALSE(factor_lu(a, pivots.data())) << order << ", " << zero;
    }
}

TEST(FactorLu, OfOrderZeroSucceeds) {
  Matrix a(0, 0);
  EXPECT_TRUE(factor_lu(a, nullptr));
  solve_lu(a, nullptr, nullptr);
}

// det of a permutation is its sign; scaling a row by -1 turns the sign; a zero row gives 0.
TEST(DeterminantSign, IsThatOfPermutationsAndOfReflections) {
  Arena arena;
  for (int order : {1, 2, 3, 5, 16, 17, 30}) {
    Matrix one = identity(order);
    EXPECT_EQ(determinant_sign(one, arena), 1);
    for (int shift = 0; shift < order; ++shift) {
      // The cyclic shift by s of k elements is the s-th power of a cycle of length k, whose sign is (-1)^(k-1).
      Matrix cycle(order, order);
      for (int i = 0; i < order; ++i) cycle((i + shift) % order, i) = 0.5 + i;
      EXPECT_EQ(determinant_sign(cycle, arena), (order - 1) * shift % 2 == 0 ? 1 : -1) << order << ", " << shift;
    }
    Matrix mirrored = identity(order), singular = identity(order);
    mirrored(order - 1, order - 1) = -2.0;
    singular(order / 2, order / 2) = 0.0;
    EXPECT_EQ(determinant_sign(mirrored, arena), -1);
    EXPECT_EQ(determinant_sign(singular, arena), 0);
  }
  Matrix nothing(0, 0);
  EXPECT_EQ(determinant_sign(nothing, arena), 1);  // the empty product
}

// ---- Singular values ----

TEST(SingularValues, FactorsAreOrthogonalOrderedAndGiveTheMatrixBack) {
  for (const Shape s : shapes) {
    const Matrix a = random_matrix(s.rows, s.cols, 24);
    const Guarded in(a);
    const Svd f = svd(in.view);
    ASSERT_EQ(f.U.rows(), s.rows);
    ASSERT_EQ(f.U.cols(), s.rows);
    ASSERT_EQ(f.V.rows(), s.cols);
    ASSERT_EQ(f.V.cols(), s.cols);
    EXPECT_LE(orthonormality_defect(f.U), rounding(s.rows));
    EXPECT_LE(orthonormality_defect(f.V), rounding(s.cols));
    Matrix diagonal(s.rows, s.cols);
    for (std::size_t k = 0; k < f.s.size(); ++k) {
      diagonal(static_cast<int>(k), static_cast<int>(k)) = f.s[k];
      EXPECT_GE(f.s[k], 0.0);
      EXPECT_LE(f.s[k], f.s[k > 0 ? k - 1 : 0]);
    }
    const double scale = f.s.empty() ? 1.0 : f.s[0];
    EXPECT_LE(distance(times(f.U, times(diagonal, transposed(f.V))), a), rounding(s.rows + s.cols) * scale);
  }
}

// LAPACK computes singular values without vectors by a method that divides by zero on purpose: no traps here.
TEST(SingularValues, WithoutVectorsAreTheSame) {
  std::fenv_t environment;
  std::feholdexcept(&environment);
  for (const Shape s : shapes) {
    const Matrix a = random_matrix(s.rows, s.cols, 24);
    const Guarded in(a);
    const std::vector<double> with = svd(a).s, without = singular_values(in.view);
    EXPECT_LE(distance(without, with), rounding(s.rows + s.cols) * (with.empty() ? 1.0 : with[0]));
  }
  std::fesetenv(&environment);
}

// Programs that run with floating-point traps would end there.
TEST(SingularValues, RaiseNoFloatingPointExceptions) {
  const Matrix a = random_matrix(25, 25, 24);
  std::feclearexcept(FE_ALL_EXCEPT);
  singular_values(a);
  EXPECT_EQ(std::fetestexcept(FE_OVERFLOW | FE_INVALID | FE_DIVBYZERO), 0);
}

TEST(RangeBasis, IsOrthonormalAndSpansTheRange) {
  for (const Shape s : {Shape{1, 1}, {6, 4}, {4, 6}, {30, 20}, {70, 40}})
    for (int rank : {0, 1, std::min(s.rows, s.cols) / 2, std::min(s.rows, s.cols)}) {
      const Matrix a = matrix_of_rank(s.rows, s.cols, rank, 25);
      const Matrix q = range_basis(a, rank);
      ASSERT_EQ(q.cols(), rank);
      EXPECT_LE(orthonormality_defect(q), rounding(s.rows));
      EXPECT_LE(outside_range(q, a), rounding(s.rows + s.cols) * std::max(1.0, largest(a) * s.cols));
    }
}

// The two properties that define A^+ b: A^T (A x - b) = 0, and x is orthogonal to the kernel of A.
TEST(LeastSquares, FulfilsTheNormalEquationsAndHasMinimumNorm) {
  for (const Shape s : {Shape{1, 1}, {6, 4}, {4, 6}, {5, 0}, {0, 5}, {30, 20}, {20, 30}})
    for (int rank : {0, 1, std::min(s.rows, s.cols) / 2, std::min(s.rows, s.cols)}) {
      if (rank > std::min(s.rows, s.cols)) continue;
      const Matrix a = matrix_of_rank(s.rows, s.cols, rank, 26);
      const double scale = std::max(largest(a), 1.0) * (s.rows + s.cols);
      const std::vector<double> b = random_vector(s.rows, 27);
      const std::vector<double> x = least_squares(a, b, rounding(s.rows + s.cols) * scale);
      ASSERT_EQ(x.size(), size(s.cols));
      // Errors of x are amplified by the condition, below 1e6 for these seeds (checked below).
      const std::vector<double> s_values = svd(a).s;
      const double smallest = rank > 0 ? s_values[size(rank - 1)] : 1.0;
      ASSERT_GT(smallest, 1e-6 * scale);
      const double tolerance = rounding(s.rows + s.cols) * scale * scale / smallest * (1.0 + largest(x));
      const Matrix residual = sfdae_test::sum(1.0, times(a, column(x)), -1.0, column(b));
      EXPECT_LE(largest(times(transposed(a), residual)), tolerance);
      const Svd f = svd(a);
      const ConstView kernel = f.V.view().columns(rank, s.cols - rank);
      EXPECT_LE(largest(times(transposed(kernel), column(x))), tolerance);
    }
}

// diag(1, t): t is dropped if it does not exceed the threshold, and kept if it does.
TEST(LeastSquares, DropsSingularValuesUpToTheThreshold) {
  Matrix a = identity(2);
  a(1, 1) = 0.25;
  EXPECT_EQ(least_squares(a, {1.0, 1.0}, 0.25)[1], 0.0);
  EXPECT_NEAR(least_squares(a, {1.0, 1.0}, 0.2)[1], 4.0, 4.0 * rounding(2));
}

}  // namespace sfdae::core
