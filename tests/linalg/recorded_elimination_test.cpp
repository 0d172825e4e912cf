// SPDX-License-Identifier: BSD-3-Clause
// A recorded elimination: residuals with the values that pivots were chosen by and with others, pivots that are refused.
#include "linalg/recorded_elimination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "linalg/random.h"
#include "matrix_checks.h"
#include "sparse_matrices.h"

namespace sfdae::core {

namespace {

using sfdae_test::SparseMatrix;
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
  std::vector<double> x = b;
  elimination.solve(factors, x.data());
  return residual(pattern, values, x, b);
}

// Growth of factors with threshold pivoting, and rows of small |A| |x|, are worth a factor of 1000.
double tolerance(int size) { return 1e3 * size * unit_roundoff; }

}  // namespace

TEST(RecordedElimination, SolvesWithTheValuesThatItWasChosenByAndWithOthers) {
  for (const SparseMatrix& matrix :
       {sfdae_test::reaction_diffusion(40), sfdae_test::flow(5), sfdae_test::arrow(60, 2), sfdae_test::arrow(12, 12),
        sfdae_test::random_sparse(70, 2, 6), sfdae_test::random_band(1, 0, 0, 2.0, 1)}) {
    const int n = matrix.pattern.size;
    SCOPED_TRACE(n);
    RecordedElimination elimination;
    ASSERT_TRUE(elimination.choose(matrix.pattern, matrix.values.data()));
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
  ASSERT_TRUE(elimination.choose(scaled.pattern, scaled.values.data()));
  std::vector<double> factors(elimination.fill());
  ASSERT_TRUE(elimination.factor(scaled.values.data(), factors.data()));
  EXPECT_LE(relative_residual(scaled.pattern, scaled.values.data(), elimination, factors.data()), tolerance(n));
}

// Chosen on the diagonal.
TEST(RecordedElimination, RefusesPivotsThatHaveBecomeSmall) {
  const SparseMatrix full = sfdae_test::sparse_matrix(2, {{0, 0, 1.0}, {0, 1, 0.5}, {1, 0, 0.5}, {1, 1, 1.0}});
  RecordedElimination elimination;
  ASSERT_TRUE(elimination.choose(full.pattern, full.values.data()));
  std::vector<double> factors(elimination.fill());
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double small : {0.0, 1e-4, infinity}) {
    const std::vector<double> values = {small, 1.0, 1.0, small};
    EXPECT_FALSE(elimination.factor(values.data(), factors.data())) << small;
  }
  const std::vector<double> singular = {1.0, 1.0, 1.0, 1.0};
  EXPECT_FALSE(elimination.factor(singular.data(), factors.data()));
  EXPECT_FALSE(elimination.choose(full.pattern, singular.data()));
  const std::vector<double> not_a_number = {1.0, std::nan(""), 1.0, 1.0};
  EXPECT_FALSE(elimination.choose(full.pattern, not_a_number.data()));
}

}  // namespace sfdae::core
