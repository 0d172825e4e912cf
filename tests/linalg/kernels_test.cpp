// SPDX-License-Identifier: BSD-3-Clause
// QR factorizations and loops over arrays with every instruction set that the processor has: defining properties of the
// factors, ranks as LAPACK finds them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "linalg/dense.h"
#include "linalg/kernels_in_use.h"
#include "matrix_checks.h"

extern "C" void dgeqp3_(const int* m, const int* n, double* a, const int* lda, int* jpvt, double* tau, double* work,
                        const int* lwork, int* info);

namespace sfdae::core {

namespace {

using sfdae_test::distance;
using sfdae_test::largest;
using sfdae_test::orthonormality_defect;
using sfdae_test::random_matrix;
using sfdae_test::rounding;
using sfdae_test::size;
using sfdae_test::times;

struct KernelShape {
  int rows, cols;
};

// Around the crossovers (12 rows, 40 and 16 columns), around multiples of the widths of vectors, far from square.
constexpr KernelShape kernel_shapes[] = {{13, 13},  {16, 16},  {17, 9},   {16, 40},   {24, 23},   {33, 20},
                                         {41, 41},  {48, 64},  {64, 48},  {65, 57},   {100, 100}, {100, 34},
                                         {34, 100}, {13, 130}, {130, 13}, {128, 128}, {13, 1},    {150, 143}};

// The kinds of matrices, with their ranks if these are clear by many digits, else -1.
struct Sample {
  std::string name;
  Matrix A;
  int rank;
};

void multiply_columns(Matrix& A, int first, double factor) {
  for (int j = first; j < A.cols(); j += 3)
    for (int i = 0; i < A.rows(); ++i) A(i, j) *= factor;
}

// Kahan's matrix, on which updated norms without care lose all digits.
Matrix kahan(int rows, int cols) {
  constexpr double c = 0.285, s = 0.9585;
  Matrix A(rows, cols);
  double power = 1.0;
  for (int i = 0; i < std::min(rows, cols); ++i, power *= s) {
    A(i, i) = power;
    for (int j = i + 1; j < cols; ++j) A(i, j) = -c * power;
  }
  return A;
}

std::vector<Sample> samples(KernelShape shape) {
  const int m = shape.rows, n = shape.cols, full = std::min(m, n), half = (full + 1) / 2;
  std::vector<Sample> result;
  result.push_back({"random", random_matrix(m, n, 1), full});
  result.push_back({"deficient", times(random_matrix(m, half, 2), random_matrix(half, n, 3)), half});
  Matrix columns = random_matrix(m, n, 4);
  multiply_columns(columns, 0, 1e8);
  multiply_columns(columns, 1, 1e-8);
  result.push_back({"graded columns", columns, -1});
  Matrix rows = sfdae_test::transposed(columns);
  result.push_back({"graded rows", m == n ? rows : sfdae_test::transposed(random_matrix(n, m, 5)), -1});
  Matrix zero = random_matrix(m, n, 6);
  multiply_columns(zero, 0, 0.0);
  result.push_back({"zero columns", zero, std::min(m, n - (n + 2) / 3)});
  result.push_back({"nothing", Matrix(m, n), 0});
  result.push_back({"Kahan", kahan(m, n), -1});
  Matrix huge = random_matrix(m, n, 7), tiny = huge;
  multiply_columns(huge, 0, 1e200);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < m; ++i) tiny(i, j) *= 1e-200;
  result.push_back({"huge", huge, std::min(m, (n + 2) / 3)});
  result.push_back({"tiny", tiny, full});
  return result;
}

struct Factors {
  explicit Factors(const Matrix& A)
      : QR(A), pivots(size(A.cols()) + 1), tau(size(std::min(A.rows(), A.cols())) + 1) {}
  Matrix R() const {
    Matrix R(QR.rows(), QR.cols());
    for (int j = 0; j < QR.cols(); ++j)
      for (int i = 0; i <= std::min(j, QR.rows() - 1); ++i) R(i, j) = QR(i, j);
    return R;
  }
  int steps() const { return std::min(QR.rows(), QR.cols()); }
  Matrix QR;
  std::vector<int> pivots;
  std::vector<double> tau;
};

int rank_of(const Matrix& R, double threshold) {
  int rank = 0;
  while (rank < std::min(R.rows(), R.cols()) && std::fabs(R(rank, rank)) > threshold) ++rank;
  return rank;
}

int rank_by_lapack(Matrix A, double threshold) {
  const int m = A.rows(), n = A.cols(), length = 64 * (m + n) + 100;
  std::vector<int> pivots(size(n), 0);
  std::vector<double> tau(size(n)), work(size(length));
  int info = 0;
  dgeqp3_(&m, &n, A.data(), &m, pivots.data(), tau.data(), work.data(), &length, &info);
  return rank_of(A, threshold);
}

class EveryInstructionSet : public testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    const kernels::Loops* wanted = kernels::loops_for(GetParam());
    if (wanted == nullptr) GTEST_SKIP() << "not on this processor, or not in this build";
    kernels::loops_in_use = wanted;
  }
  void TearDown() override { kernels::loops_in_use = nullptr; }
  Arena arena_;
};

}  // namespace

// What is left of any column when r_kk is chosen is not longer than r_kk: r_kk^2 >= sum_{i=k}^{j} r_ij^2. Updated
// squares are known to 1e-8 relative.
TEST_P(EveryInstructionSet, PivotedFactorsAreThoseOfTheMatrix) {
  for (const KernelShape shape : kernel_shapes)
    for (const Sample& sample : samples(shape)) {
      SCOPED_TRACE(sample.name + " " + std::to_string(shape.rows) + " x " + std::to_string(shape.cols));
      const int m = shape.rows, n = shape.cols;
      Factors f(sample.A);
      factor_qr_pivoted(f.QR, f.pivots.data(), f.tau.data(), arena_);
      const Matrix R = f.R();
      Matrix Q(m, m), AP(m, n);
      form_q(f.QR, f.steps(), f.tau.data(), Q, arena_);
      ASSERT_TRUE(std::is_permutation(f.pivots.begin(), f.pivots.end() - 1,
                                      [&] {
                                        std::vector<int> all(size(n));
                                        for (int j = 0; j < n; ++j) all[size(j)] = j;
                                        return all;
                                      }()
                                          .begin()));
      for (int j = 0; j < n; ++j) std::copy_n(sample.A.view().column(f.pivots[size(j)]), m, AP.view().column(j));
      const double norm = largest(sample.A), unit = norm > 0.0 ? norm : 1.0;
      EXPECT_LE(orthonormality_defect(Q), rounding(m));
      Matrix scaled_AP = AP, scaled_R = R;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < m; ++i) {
          scaled_AP(i, j) /= unit;
          scaled_R(i, j) /= unit;
        }
      EXPECT_LE(distance(times(Q, scaled_R), scaled_AP), rounding(m));
      for (int j = 1; j < n; ++j) {
        double left = j < m ? scaled_R(j, j) * scaled_R(j, j) : 0.0;
        for (int k = std::min(j, f.steps()) - 1; k >= 0; --k) {
          left += scaled_R(k, j) * scaled_R(k, j);
          ASSERT_LE(std::sqrt(left), (1.0 + 1e-7) * std::fabs(scaled_R(k, k)) + rounding(m)) << k << ' ' << j;
        }
      }
    }
}

// What is left below the bound is taken for zero: the factors are those of a matrix that differs by no more than that.
TEST_P(EveryInstructionSet, PivotedFactorsEndWhereNothingIsLeftThatCounts) {
  for (const KernelShape shape : kernel_shapes)
    for (const Sample& sample : samples(shape)) {
      SCOPED_TRACE(sample.name + " " + std::to_string(shape.rows) + " x " + std::to_string(shape.cols));
      const int m = shape.rows, n = shape.cols;
      const double norm = largest(sample.A), unit = norm > 0.0 ? norm : 1.0;
      const double negligible = unit * rounding(m);
      Factors whole(sample.A), f(sample.A);
      factor_qr_pivoted(whole.QR, whole.pivots.data(), whole.tau.data(), arena_);
      factor_qr_pivoted(f.QR, f.pivots.data(), f.tau.data(), arena_, negligible);
      const int rank = rank_of(f.QR, negligible);
      EXPECT_EQ(rank, rank_of(whole.QR, negligible));
      if (rank < f.steps()) {
        EXPECT_NEAR(std::fabs(f.QR(rank, rank)) / unit, std::fabs(whole.QR(rank, rank)) / unit, rounding(m));
      }
      for (int k = rank + 1; k < f.steps(); ++k) EXPECT_EQ(f.QR(k, k), 0.0);
      Matrix Q(m, m), AP(m, n);
      form_q(f.QR, rank, f.tau.data(), Q, arena_);
      Matrix R = f.R();
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < m; ++i) {
          AP(i, j) = sample.A(i, f.pivots[size(j)]) / unit;
          R(i, j) = i < rank ? R(i, j) / unit : 0.0;
        }
      EXPECT_LE(distance(times(Q, R), AP), 2.0 * rounding(m));
    }
}

TEST_P(EveryInstructionSet, RanksAreThoseOfLapack) {
  for (const KernelShape shape : kernel_shapes)
    for (const Sample& sample : samples(shape)) {
      SCOPED_TRACE(sample.name + " " + std::to_string(shape.rows) + " x " + std::to_string(shape.cols));
      const double threshold = largest(sample.A) * rounding(shape.rows + shape.cols);
      Factors f(sample.A);
      factor_qr_pivoted(f.QR, f.pivots.data(), f.tau.data(), arena_);
      // Not every BLAS has norms that neither over- nor underflow.
      if (sample.name != "huge" && sample.name != "tiny") {
        EXPECT_EQ(rank_of(f.QR, threshold), rank_by_lapack(sample.A, threshold));
      }
      if (sample.rank >= 0) {
        EXPECT_EQ(rank_of(f.QR, threshold), sample.rank);
      }
    }
}

TEST_P(EveryInstructionSet, QIsAppliedFromBothSides) {
  for (const KernelShape shape : kernel_shapes) {
    SCOPED_TRACE(std::to_string(shape.rows) + " x " + std::to_string(shape.cols));
    const Matrix A = random_matrix(shape.rows, shape.cols, 11);
    Factors f(A);
    factor_qr(f.QR, f.tau.data(), arena_);
    Matrix C = A;
    apply_q(Op::transposed, f.QR, f.steps(), f.tau.data(), C, arena_);
    EXPECT_LE(distance(C, f.R()), rounding(shape.rows));
    apply_q(Op::plain, f.QR, f.steps(), f.tau.data(), C, arena_);
    EXPECT_LE(distance(C, A), rounding(shape.rows));
    // The first of them only, and as many columns of Q.
    const int count = (f.steps() + 1) / 2;
    Matrix Q(shape.rows, count), first(shape.rows, count);
    form_q(f.QR, count, f.tau.data(), Q, arena_);
    for (int j = 0; j < count; ++j) first(j, j) = 1.0;
    apply_q(Op::plain, f.QR, count, f.tau.data(), first, arena_);
    EXPECT_LE(distance(Q, first), rounding(shape.rows));
    Matrix last(shape.rows, shape.rows - f.steps()), unit(shape.rows, last.cols());
    for (int j = 0; j < last.cols(); ++j) unit(f.steps() + j, j) = 1.0;
    form_last_q(f.QR, f.steps(), f.tau.data(), last, arena_);
    apply_q(Op::plain, f.QR, f.steps(), f.tau.data(), unit, arena_);
    EXPECT_LE(distance(last, unit), rounding(shape.rows));
    EXPECT_LE(orthonormality_defect(Q), rounding(shape.rows));
  }
}

// Nobody passes such values, as they are refused where they come from; that nothing hangs or is written outside of the
// arrays is all that is asked for.
TEST_P(EveryInstructionSet, ValuesThatAreNotFiniteEndLikeOthers) {
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    for (const int n : {16, 50, 100}) {
      fenv_t traps;
      feholdexcept(&traps);
      Matrix A = random_matrix(n, n, 12);
      A(n / 2, n / 3) = value;
      Factors f(A);
      factor_qr_pivoted(f.QR, f.pivots.data(), f.tau.data(), arena_);
      fesetenv(&traps);
      std::vector<int> sorted(f.pivots.begin(), f.pivots.end() - 1);
      std::sort(sorted.begin(), sorted.end());
      for (int j = 0; j < n; ++j) EXPECT_EQ(sorted[size(j)], j);
    }
}

TEST_P(EveryInstructionSet, ArraysOfAnyLengthAreMeasuredAndScaled) {
  const kernels::ArrayLoops& arrays = kernels::loops().arrays;
  for (int count = 0; count < 40; ++count) {
    const std::vector<double> x = sfdae_test::random_vector(count + 2, 13), factors(size(count) + 1, -0.5);
    double most = 0.0;
    for (int i = 0; i < count; ++i) most = std::max(most, std::fabs(x[size(i + 1)]));
    EXPECT_EQ(arrays.largest_size(x.data() + 1, count), most);
    std::vector<double> scaled = x, sizes(size(count) + 1, 0.25);
    EXPECT_EQ(arrays.scale_entries(scaled.data() + 1, factors.data(), count), 0.5 * most);
    arrays.raise_sizes(x.data() + 1, 2.0, count, sizes.data());
    for (int i = 0; i < count; ++i) {
      EXPECT_EQ(scaled[size(i + 1)], -0.5 * x[size(i + 1)]);
      EXPECT_EQ(sizes[size(i)], std::max(0.25, 2.0 * std::fabs(x[size(i + 1)])));
    }
    EXPECT_EQ(scaled.front(), x.front());
    EXPECT_EQ(scaled.back(), x.back());
    EXPECT_EQ(sizes.back(), 0.25);
  }
}

TEST_P(EveryInstructionSet, EveryPlaceIsCheckedForValuesThatAreNotFinite) {
  const kernels::ArrayLoops& arrays = kernels::loops().arrays;
  constexpr double infinity = std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::max();
  for (int count = 0; count < 40; ++count) {
    std::vector<double> x(size(count) + 2, most);
    x.front() = x.back() = infinity;
    EXPECT_TRUE(arrays.all_finite(x.data() + 1, size(count)));
    for (int i = 1; i <= count; ++i)
      for (const double value : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
        x[size(i)] = value;
        std::feclearexcept(FE_ALL_EXCEPT);
        EXPECT_FALSE(arrays.all_finite(x.data() + 1, size(count))) << i;
        EXPECT_EQ(std::fetestexcept(FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO), 0);
        x[size(i)] = -most;
      }
  }
}

// Of the entries of a larger array, which are none of its business: what lies beside A and B is NaN.
TEST_P(EveryInstructionSet, ProductsAreThoseOfPlainSums) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr int gap = 3;
  const auto framed = [&](const Matrix& a) {
    Matrix frame(a.rows() + gap, a.cols());
    fill(frame, nan);
    copy(a, frame.view().top(a.rows()));
    return frame;
  };
  struct Factors {
    double alpha, beta;
  };
  for (const int rows : {1, 2, 5, 8, 11, 12, 16, 17, 23, 24, 31, 33, 50})
    for (const int cols : {1, 2, 3, 5, 8, 9, 14, 17})
      for (const int inner : {1, 4, 7, 16, 30, 112, 113})
        for (const auto& [alpha, beta] : {Factors{1.0, 0.0}, Factors{-1.0, 1.0}, Factors{-0.3, 0.7}}) {
          const Matrix A = random_matrix(rows, inner, 3), B = random_matrix(inner, cols, 5);
          const Matrix C = random_matrix(rows, cols, 7), AB = times(A, B);
          for (const Op op_a : {Op::plain, Op::transposed})
            for (const Op op_b : {Op::plain, Op::transposed}) {
              const Matrix a = framed(op_a == Op::plain ? A : transpose(A));
              const Matrix b = framed(op_b == Op::plain ? B : transpose(B));
              Matrix c = framed(C);
              if (beta == 0.0) fill(c.view().top(rows), nan);
              multiply(alpha, op_a, a.view().top(a.rows() - gap), op_b, b.view().top(b.rows() - gap), beta,
                       c.view().top(rows));
              double worst = 0.0;
              for (int j = 0; j < cols; ++j) {
                for (int i = 0; i < rows; ++i) {
                  const double error = std::fabs(c(i, j) - (alpha * AB(i, j) + (beta == 0.0 ? 0.0 : beta * C(i, j))));
                  worst = error <= worst ? worst : error;  // NaN counts
                }
                for (int i = rows; i < rows + gap; ++i) ASSERT_TRUE(std::isnan(c(i, j)));
              }
              ASSERT_LE(worst, rounding(inner)) << rows << " x " << inner << " x " << cols;
            }
        }
}

// Rounding errors of products that are not made would be taken for values.
TEST_P(EveryInstructionSet, DifferencesOfRoundedProductsVanish) {
  const double third = 1.0 / 3.0;
  for (int count = 0; count < 40; ++count) {
    const std::vector<double> y = sfdae_test::random_vector(count + 1, 17);
    std::vector<double> x(y.size()), difference(y.size(), 1.0);
    for (std::size_t i = 0; i < y.size(); ++i) {
      const volatile double product = third * y[i];
      x[i] = product;
    }
    kernels::loops().arrays.subtract(x.data(), third, y.data(), count, difference.data());
    for (int i = 0; i < count; ++i) EXPECT_EQ(difference[size(i)], 0.0) << i;
    EXPECT_EQ(difference.back(), 1.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, EveryInstructionSet,
                         testing::Values(InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512),
                         [](const testing::TestParamInfo<InstructionSet>& set) {
                           return set.param == InstructionSet::portable ? "portable"
                                  : set.param == InstructionSet::avx2   ? "avx2"
                                                                        : "avx512";
                         });

TEST(Loops, AreChosenByTheEnvironment) {
  const char* before = std::getenv("SFDAE_INSTRUCTIONS");
  const std::string kept = before != nullptr ? before : "";
  setenv("SFDAE_INSTRUCTIONS", "portable", 1);
  EXPECT_STREQ(kernels::choose_loops().name, "portable");
  setenv("SFDAE_INSTRUCTIONS", "avx2", 1);
  EXPECT_STREQ(kernels::choose_loops().name, kernels::loops_for(InstructionSet::avx2) ? "avx2" : "portable");
  unsetenv("SFDAE_INSTRUCTIONS");
  for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2, InstructionSet::portable}) {
    if (kernels::loops_for(set) == nullptr) continue;
    EXPECT_EQ(&kernels::choose_loops(), kernels::loops_for(set));
    break;
  }
  if (before != nullptr) setenv("SFDAE_INSTRUCTIONS", kept.c_str(), 1);
  kernels::loops_in_use = nullptr;
}

}  // namespace sfdae::core
