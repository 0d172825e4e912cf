// SPDX-License-Identifier: BSD-3-Clause
// A recorded elimination: residuals with the values that pivots were chosen by and with others, pivots that are
// refused.
#include "linalg/recorded_elimination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <random>
#include <vector>

#include "instruction_sets.h"
#include "linalg/listed_factors.h"
#include "linalg/random.h"
#include "linalg/sparse_lu.h"
#include "matrix_checks.h"
#include "sparse_matrices.h"

namespace sfdae::core {

namespace {

using sfdae_test::SparseMatrix;
using Choice = RecordedElimination::Choice;
using sfdae_test::unit_roundoff;

std::vector<double> random_vector(std::size_t size, unsigned seed) {
  std::minstd_rand generator(seed);
  std::vector<double> v(size);
  for (double& entry : v) entry = symmetric_random(generator);
  return v;
}

// The largest |A x - b|_i / (|A| |x| + |b|)_i (Oettli and Prager, 1964).
double residual(const SparsePattern& pattern, const double* values, const std::vector<double>& x,
                const std::vector<double>& b) {
  std::vector<double> r(b), size(b.size());
  for (std::size_t i = 0; i < b.size(); ++i) size[i] = std::fabs(b[i]);
  for (int j = 0; j < pattern.size; ++j)
    for (int k = pattern.first[index(j)]; k < pattern.first[index(j) + 1]; ++k) {
      const std::size_t i = index(pattern.row[index(k)]);
      r[i] -= values[k] * x[index(j)];
      size[i] += std::fabs(values[k] * x[index(j)]);
    }
  double largest = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i)
    if (r[i] != 0.0) largest = std::max(largest, std::fabs(r[i]) / size[i]);
  return largest;
}

double relative_residual(const SparsePattern& pattern, const double* values, RecordedElimination& elimination,
                         const double* factors) {
  const std::vector<double> b = random_vector(index(pattern.size), 5);
  std::vector<double> x = b, work(elimination.size());
  elimination.solve(factors, x.data(), work.data());
  return residual(pattern, values, x, b);
}

// Growth of factors with threshold pivoting, and rows of small |A| |x|, are worth a factor of 1000.
double tolerance(int size) { return 1e3 * size * unit_roundoff; }

}  // namespace

TEST(RecordedElimination, SolvesWithTheValuesThatItWasChosenByAndWithOthers) {
  for (const SparseMatrix& matrix :
       {sfdae_test::reaction_diffusion(40), sfdae_test::flow(4), sfdae_test::arrow(60, 2), sfdae_test::arrow(12, 12),
        sfdae_test::random_sparse(40, 2, 6), sfdae_test::random_band(1, 0, 0, 2.0, 1)}) {
    const int n = matrix.pattern.size;
    SCOPED_TRACE(n);
    RecordedElimination elimination;
    ASSERT_EQ(elimination.choose(matrix.pattern, matrix.values.data()), Choice::made);
    std::vector<double> factors(elimination.fill());
    ASSERT_TRUE(elimination.factor(matrix.values.data(), factors.data()));
    EXPECT_LE(relative_residual(matrix.pattern, matrix.values.data(), elimination, factors.data()), tolerance(n));
    std::vector<double> others = random_vector(matrix.values.size(), 9);
    for (std::size_t k = 0; k < others.size(); ++k) others[k] = matrix.values[k] * (1.0 + 0.02 * others[k]);
    ASSERT_TRUE(elimination.factor(others.data(), factors.data()));
    EXPECT_LE(relative_residual(matrix.pattern, others.data(), elimination, factors.data()), tolerance(n));
  }
}

// Powers of two change no bit.
TEST(RecordedElimination, DoesNotDependOnUnits) {
  const SparseMatrix matrix = sfdae_test::random_sparse(30, 2, 8);
  const int n = matrix.pattern.size;
  SparseMatrix scaled = matrix;
  for (int j = 0; j < n; ++j)
    for (int k = matrix.pattern.first[index(j)]; k < matrix.pattern.first[index(j) + 1]; ++k)
      scaled.values[index(k)] =
          std::ldexp(matrix.values[index(k)], 40 * (j % 3) - 50 * (matrix.pattern.row[index(k)] % 2));
  RecordedElimination elimination;
  ASSERT_EQ(elimination.choose(scaled.pattern, scaled.values.data()), Choice::made);
  std::vector<double> factors(elimination.fill());
  ASSERT_TRUE(elimination.factor(scaled.values.data(), factors.data()));
  EXPECT_LE(relative_residual(scaled.pattern, scaled.values.data(), elimination, factors.data()), tolerance(n));
}

// Chosen on the diagonal.
TEST(RecordedElimination, RefusesPivotsThatHaveBecomeSmall) {
  const SparseMatrix full = sfdae_test::sparse_matrix(2, {{0, 0, 1.0}, {0, 1, 0.5}, {1, 0, 0.5}, {1, 1, 1.0}});
  RecordedElimination elimination;
  ASSERT_EQ(elimination.choose(full.pattern, full.values.data()), Choice::made);
  std::vector<double> factors(elimination.fill());
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double small : {0.0, 1e-4, infinity}) {
    const std::vector<double> values = {small, 1.0, 1.0, small};
    EXPECT_FALSE(elimination.factor(values.data(), factors.data())) << small;
  }
  const std::vector<double> singular = {1.0, 1.0, 1.0, 1.0};
  EXPECT_FALSE(elimination.factor(singular.data(), factors.data()));
  EXPECT_EQ(elimination.choose(full.pattern, singular.data()), Choice::singular);
  EXPECT_FALSE(elimination.has_pivots());
  const std::vector<double> not_a_number = {1.0, std::nan(""), 1.0, 1.0};
  EXPECT_EQ(elimination.choose(full.pattern, not_a_number.data()), Choice::singular);
}

// By a list of operations and by LAPACK.
struct BothFactors {
  explicit BothFactors(const SparseMatrix& matrix) {
    EXPECT_EQ(elimination.choose(matrix.pattern, matrix.values.data()), Choice::made);
    factors.resize(elimination.fill());
    EXPECT_TRUE(elimination.factor(matrix.values.data(), factors.data()));
    lu.analyze(matrix.pattern, SparseMethod::dense);
    EXPECT_TRUE(lu.factor(matrix.values.data()));
  }
  RecordedElimination elimination;
  std::vector<double> factors;
  SparseLu<double> lu;
};

// Against 1 / (|S| |S^-1|) of the scaled matrix, column by column of its inverse; the estimate is a lower bound of
// |S^-1|.
TEST(RecordedElimination, EstimatesTheConditionOfTheScaledMatrix) {
  for (const SparseMatrix& matrix : {sfdae_test::random_sparse(40, 2, 6), sfdae_test::flow(4)}) {
    const int n = matrix.pattern.size;
    BothFactors both(matrix);
    if (HasFailure()) return;
    const double estimate = both.elimination.reciprocal_condition(matrix.values.data(), both.factors.data());
    // Both scale in the same way.
    EXPECT_NEAR(estimate / both.lu.reciprocal_condition(), 1.0, 1e-6) << n;
  }
}

TEST(RecordedElimination, HasTheDeterminant) {
  for (const SparseMatrix& matrix : {sfdae_test::random_sparse(40, 2, 6), sfdae_test::random_sparse(41, 2, 7),
                                     sfdae_test::random_sparse(42, 2, 8), sfdae_test::flow(4)}) {
    BothFactors both(matrix);
    if (HasFailure()) return;
    const Determinant<double> own = both.elimination.determinant(both.factors.data()), other = both.lu.determinant();
    EXPECT_EQ(own.direction, other.direction) << matrix.pattern.size;
    EXPECT_NEAR(own.log2, other.log2, 1e-9) << matrix.pattern.size;
  }
}

// The elimination of a full matrix of 160 rows takes 8500 operations a row.
TEST(RecordedElimination, LeavesLongListsToOthers) {
  const int n = 160;
  std::vector<sfdae_test::Triplet> entries;
  std::minstd_rand generator(3);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) entries.push_back({i, j, symmetric_random(generator)});
  const SparseMatrix full = sfdae_test::sparse_matrix(n, entries);
  RecordedElimination elimination;
  EXPECT_EQ(elimination.choose(full.pattern, full.values.data()), Choice::too_long);
  ListedFactors<double> factors;
  EXPECT_FALSE(factors.factor(full.pattern, full.values.data()));
}

// Pivots chosen by other values than those factored, which another choice would differ from.
TEST(ListedFactors, GoOnFromArchivesInEveryBit) {
  const SparseMatrix matrix = sfdae_test::random_sparse(60, 2, 6);
  const int n = matrix.pattern.size;
  ListedFactors<double> first;
  ASSERT_TRUE(first.factor(matrix.pattern, matrix.values.data()));
  std::vector<double> others = random_vector(matrix.values.size(), 4);
  for (std::size_t k = 0; k < others.size(); ++k) others[k] = matrix.values[k] * (1.0 + 0.5 * others[k]);
  ASSERT_TRUE(first.factor(matrix.pattern, others.data()));
  Archive counter = Archive::counter();
  first.archive(matrix.pattern, counter);
  std::vector<double> saved(counter.size());
  Archive writer = Archive::writer(saved.data(), saved.size());
  first.archive(matrix.pattern, writer);
  EXPECT_TRUE(writer.has_ended());

  ListedFactors<double> second;
  Archive reader = Archive::reader(saved.data(), saved.size());
  second.archive(matrix.pattern, reader);
  EXPECT_TRUE(reader.has_ended());
  ASSERT_TRUE(second.factor(matrix.pattern, others.data()));
  const std::vector<double> b = random_vector(index(n), 6);
  std::vector<double> x = b, y = b;
  first.solve(x.data());
  second.solve(y.data());
  EXPECT_EQ(x, y);
  // The first rows twice.
  saved[2] = saved[3];
  Archive damaged = Archive::reader(saved.data(), saved.size());
  EXPECT_THROW(second.archive(matrix.pattern, damaged), DamagedArchive);
}

// Eight matrices side by side, with every instruction set.
TEST(RecordedElimination, RepeatsItselfInLanes) {
  const SparseMatrix matrix = sfdae_test::random_sparse(50, 2, 6);
  const std::size_t n = index(matrix.pattern.size);
  RecordedElimination elimination;
  ASSERT_EQ(elimination.choose(matrix.pattern, matrix.values.data()), Choice::made);
  LaneArray values(matrix.values.size()), factors(elimination.fill()), b(n);
  const std::vector<double> changes = random_vector(8 * values.size(), 7), sides = random_vector(8 * n, 8);
  for (std::size_t l = 0; l < 8; ++l) {
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k].lane[l] = matrix.values[k] * (1.0 + 0.05 * changes[8 * k + l]);
    for (std::size_t i = 0; i < n; ++i) b[i].lane[l] = sides[8 * i + l];
  }
  sfdae_test::for_each_instruction_set([&](InstructionSet) {
    ASSERT_EQ(elimination.factor_lanes(values.data(), factors.data()), -1);
    LaneArray x = b;
    elimination.solve_lanes(factors.data(), x.data());
    for (std::size_t l = 0; l < 8; ++l) {
      std::vector<double> own, own_factors(elimination.fill()), y, work(n);
      for (const LaneBlock& value : values) own.push_back(value.lane[l]);
      for (const LaneBlock& side : b) y.push_back(side.lane[l]);
      ASSERT_TRUE(elimination.factor(own.data(), own_factors.data()));
      elimination.solve(own_factors.data(), y.data(), work.data());
      for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(x[i].lane[l], y[i]) << i << ", lane " << l;
    }
    // In as many lanes as are wanted, to the last bit; rows of the inverse.
    for (int count = 1; count <= 8; ++count) {
      LaneArray some = b, row(n);
      elimination.solve_lanes(factors.data(), count, some.data());
      for (int l = 0; l < count; ++l)
        for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(some[i].lane[l], x[i].lane[l]) << i << ", lane " << l;
      for (std::size_t i : {std::size_t(0), std::size_t(count), n - 1}) {
        elimination.row_of_inverse_lanes(factors.data(), count, static_cast<int>(i), row.data());
        for (int l = 0; l < count; ++l) {
          double product = 0.0, size = 0.0;
          for (std::size_t k = 0; k < n; ++k) {
            product += row[k].lane[l] * b[k].lane[l];
            size += std::fabs(row[k].lane[l] * b[k].lane[l]);
          }
          EXPECT_NEAR(product, x[i].lane[l], 1e-12 * size) << i << ", lane " << l;
        }
      }
    }
    LaneArray refused = values;
    for (int k = matrix.pattern.first[3]; k < matrix.pattern.first[4]; ++k) refused[index(k)].lane[5] = 0.0;
    EXPECT_EQ(elimination.factor_lanes(refused.data(), factors.data()), 5);
  });
}

using Complex = std::complex<double>;

// A + i B with B of the pattern of A, in units 2^(+-unit) of rows and columns.
std::vector<Complex> complex_values(const SparseMatrix& matrix, int unit, unsigned seed) {
  const std::vector<double> others = random_vector(matrix.values.size(), seed);
  std::vector<Complex> values(others.size());
  for (int j = 0; j < matrix.pattern.size; ++j)
    for (int k = matrix.pattern.first[index(j)]; k < matrix.pattern.first[index(j) + 1]; ++k)
      values[index(k)] = times_power_of_two(Complex(matrix.values[index(k)], others[index(k)]),
                                            unit * (j % 3) - unit * (matrix.pattern.row[index(k)] % 2));
  return values;
}

// The largest |A x - b|_i / (|A| |x| + |b|)_i, as for real ones.
double residual(const SparsePattern& pattern, const std::vector<Complex>& values, const std::vector<Complex>& x,
                const std::vector<Complex>& b) {
  std::vector<Complex> r(b);
  std::vector<double> size(b.size());
  for (std::size_t i = 0; i < b.size(); ++i) size[i] = std::abs(b[i]);
  for (int j = 0; j < pattern.size; ++j)
    for (int k = pattern.first[index(j)]; k < pattern.first[index(j) + 1]; ++k) {
      const Complex term = values[index(k)] * x[index(j)];
      r[index(pattern.row[index(k)])] -= term;
      size[index(pattern.row[index(k)])] += std::abs(term);
    }
  double largest = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i)
    if (r[i] != 0.0) largest = std::max(largest, std::abs(r[i]) / size[i]);
  return largest;
}

// Complex matrices, in any units; with values that change little and with others, which need other pivots.
TEST(ListedFactors, FactorComplexMatrices) {
  for (const SparseMatrix& matrix :
       {sfdae_test::reaction_diffusion(20), sfdae_test::flow(4), sfdae_test::arrow(12, 12),
        sfdae_test::random_sparse(40, 2, 6), sfdae_test::random_band(1, 0, 0, 2.0, 1)})
    for (const int unit : {0, 60}) {
      const std::size_t n = index(matrix.pattern.size);
      SCOPED_TRACE(n);
      ListedFactors<Complex> factors;
      std::vector<Complex> values = complex_values(matrix, unit, 3);
      const std::vector<double> changes = random_vector(values.size(), 9);
      for (const double change : {0.0, 0.02, 1.0, 1000.0}) {
        for (std::size_t k = 0; k < values.size(); ++k) values[k] *= Complex(1.0 + change * changes[k], 0.5 * change);
        ASSERT_TRUE(factors.factor(matrix.pattern, values.data())) << change;
        const std::vector<double> sides = random_vector(2 * n, 5);
        std::vector<Complex> b(n);
        for (std::size_t i = 0; i < n; ++i) b[i] = Complex(sides[i], sides[n + i]);
        std::vector<Complex> x = b;
        factors.solve(x.data());
        EXPECT_LE(residual(matrix.pattern, values, x, b), tolerance(matrix.pattern.size)) << change;
      }
      values[0] = Complex(0.0, std::numeric_limits<double>::infinity());
      EXPECT_FALSE(factors.factor(matrix.pattern, values.data()));
    }
  const SparseMatrix full = sfdae_test::sparse_matrix(2, {{0, 0, 1.0}, {0, 1, 0.5}, {1, 0, 0.5}, {1, 1, 1.0}});
  ListedFactors<Complex> factors;
  const std::vector<Complex> singular = {{0.0, 1.0}, {1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}};
  EXPECT_FALSE(factors.factor(full.pattern, singular.data()));
}

// Pivots that have become small are chosen anew; a matrix that is singular leaves nothing behind.
TEST(ListedFactors, ChooseOtherPivotsWhereTheseDoNotServe) {
  const SparseMatrix full = sfdae_test::sparse_matrix(2, {{0, 0, 1.0}, {0, 1, 0.5}, {1, 0, 0.5}, {1, 1, 1.0}});
  ListedFactors<double> factors;
  ASSERT_TRUE(factors.factor(full.pattern, full.values.data()));
  const std::vector<double> singular = {1.0, 1.0, 1.0, 1.0}, infinite = {1.0, HUGE_VAL, 1.0, 2.0};
  EXPECT_FALSE(factors.factor(full.pattern, singular.data()));
  EXPECT_FALSE(factors.factor(full.pattern, infinite.data()));
  const std::vector<double> turned = {1e-6, 1.0, 1.0, 1e-6};
  ASSERT_TRUE(factors.factor(full.pattern, turned.data()));
  std::vector<double> x = {1.0, 2.0};
  factors.solve(x.data());
  EXPECT_NEAR(x[0], 2.0 - 1e-6, 1e-11);
  EXPECT_NEAR(x[1], 1.0 - 2e-6, 1e-11);
}

}  // namespace sfdae::core
