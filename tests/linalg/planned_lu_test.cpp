// SPDX-License-Identifier: BSD-3-Clause
// Linear systems by listed operations: residuals, scaling, pivots that become bad, matrices that it is of no use for.
#include "linalg/planned_lu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "linalg/random.h"
#include "matrix_checks.h"
#include "sparse_matrices.h"

namespace sfdae::core {

namespace {

using sfdae_test::SparseMatrix;

std::vector<double> random_numbers(std::size_t count, unsigned seed) {
  std::minstd_rand generator(seed);
  std::vector<double> result(count);
  for (double& value : result) value = symmetric_random(generator);
  return result;
}

// max |B - A X|, relative to max (|B| + |A| |X|), of all columns.
double relative_residual(const SparseMatrix& A, const std::vector<double>& x, const std::vector<double>& b) {
  const std::size_t n = index(A.pattern.size);
  double largest = 0.0, size = 0.0;
  for (std::size_t first = 0; first < b.size(); first += n) {
    std::vector<double> r(b.begin() + static_cast<std::ptrdiff_t>(first),
                          b.begin() + static_cast<std::ptrdiff_t>(first + n)),
        sums(n);
    for (std::size_t i = 0; i < n; ++i) sums[i] = std::fabs(r[i]);
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t e = index(A.pattern.first[j]); e < index(A.pattern.first[j + 1]); ++e) {
        r[index(A.pattern.row[e])] -= A.values[e] * x[first + j];
        sums[index(A.pattern.row[e])] += std::fabs(A.values[e] * x[first + j]);
      }
    for (std::size_t i = 0; i < n; ++i) {
      largest = std::max(largest, std::fabs(r[i]));
      size = std::max(size, sums[i]);
    }
  }
  return largest / size;
}

// Solves for `count` columns and returns the residual; NaN where that was refused.
double error_of(PlannedLu& lu, const SparseMatrix& A, int count, unsigned seed) {
  const std::vector<double> b = random_numbers(index(A.pattern.size) * index(count), seed);
  std::vector<double> x(b.size());
  if (!lu.solve(A.values.data(), b.data(), count, x.data())) return std::numeric_limits<double>::quiet_NaN();
  return relative_residual(A, x, b);
}

constexpr double rounding = 2e-14;  // what is refined, times the distance of scaled equations from these

struct Named {
  std::string name;
  SparseMatrix matrix;
};

std::vector<Named> matrices() {
  return {{"line", sfdae_test::reaction_diffusion(40)},
          {"square", sfdae_test::laplacian(9, 7)},
          {"saddle point", sfdae_test::flow(6)},
          {"arrow", sfdae_test::arrow(60, 2)},
          {"small and full", sfdae_test::arrow(6, 6)},
          {"random", sfdae_test::random_sparse(70, 2, 6)},
          {"two", sfdae_test::sparse_matrix(2, {{0, 1, 3.0}, {1, 0, -2.0}})}};
}

TEST(PlannedLu, SolvesForAnyNumberOfColumns) {
  for (const Named& named : matrices())
    for (int count : {1, 2, 3, 4, 5, 9})
      for (double accepted : {rounding_of_residuals, 1e-14}) {
        PlannedLu lu;
        lu.analyze(named.matrix.pattern, accepted);
        EXPECT_LE(error_of(lu, named.matrix, count, 7), rounding) << named.name << ", " << count;
        EXPECT_TRUE(lu.is_suitable());
      }
}

TEST(PlannedLu, KeepsPivotsWhileTheyServe) {
  for (const Named& named : matrices()) {
    PlannedLu lu;
    lu.analyze(named.matrix.pattern);
    std::minstd_rand generator(3);
    SparseMatrix near = named.matrix;
    for (unsigned k = 0; k < 20; ++k) {
      for (double& value : near.values) value *= 1.0 + 0.02 * symmetric_random(generator);
      EXPECT_LE(error_of(lu, near, 2, k), rounding) << named.name;
    }
    EXPECT_EQ(lu.plans(), 1) << named.name;
  }
}

// Tiny pivots lose the rest to rounding, 1e-20 + 1 = 1, and some vanish.
TEST(PlannedLu, ChoosesPivotsAnewWhereTheyBecomeBad) {
  SparseMatrix matrix = sfdae_test::arrow(9, 9);
  std::minstd_rand generator(1);
  for (const auto& [tiny, accepted] : {std::pair(0.0, rounding_of_residuals),
                                       {1e-20, rounding_of_residuals},
                                       {1e-8, rounding_of_residuals},
                                       {0.0, 1e-14},
                                       {1e-20, 1e-14},
                                       {1e-8, 1e-14}}) {
    PlannedLu lu;
    lu.analyze(matrix.pattern, accepted);
    for (int shift = 0; shift < 9; ++shift) {
      // Large entries on a diagonal that moves.
      for (std::size_t j = 0; j < 9; ++j)
        for (std::size_t i = 0; i < 9; ++i)
          matrix.values[9 * j + i] =
              ((i + j) % 9 == index(shift) ? 1.0 : tiny) * (1.0 + 0.3 * symmetric_random(generator));
      EXPECT_LE(error_of(lu, matrix, 3, 2), rounding) << tiny << ", " << shift;
    }
    if (tiny == 0.0) {
      EXPECT_GE(lu.plans(), 2);
    }
  }
}

TEST(PlannedLu, IsUnsuitableWherePivotsChangeAllTheTime) {
  const auto matrix = [](double a, double b) {
    return sfdae_test::sparse_matrix(2, {{0, 0, a}, {0, 1, b}, {1, 0, b}, {1, 1, a}});
  };
  PlannedLu lu;
  lu.analyze(matrix(1.0, 1.0).pattern);
  int solved = 0;
  for (int k = 0; k < 200 && lu.is_suitable(); ++k) {
    const double error = error_of(lu, k % 2 == 0 ? matrix(0.0, 1.0) : matrix(1.0, 0.0), 1, 1);
    if (std::isnan(error)) break;
    EXPECT_LE(error, rounding);
    ++solved;
  }
  EXPECT_FALSE(lu.is_suitable());
  EXPECT_GE(solved, 8);
  EXPECT_LE(solved, 20);
  lu.analyze(matrix(1.0, 1.0).pattern);
  EXPECT_LE(error_of(lu, matrix(1.0, 0.5), 1, 1), rounding);
}

TEST(PlannedLu, SolvesInAnyUnits) {
  for (const Named& named : matrices()) {
    SparseMatrix scaled = named.matrix;
    for (std::size_t j = 0; j < index(scaled.pattern.size); ++j)
      for (std::size_t e = index(scaled.pattern.first[j]); e < index(scaled.pattern.first[j + 1]); ++e)
        scaled.values[e] = std::ldexp(scaled.values[e], static_cast<int>(j * 37 % 101) - 50 +
                                                            static_cast<int>(index(scaled.pattern.row[e]) * 53 % 61));
    const int n = scaled.pattern.size;
    const std::vector<double> wanted = random_numbers(index(n), 5);
    std::vector<double> b(index(n)), b_scaled(index(n)), x(index(n)), x_scaled(index(n));
    PlannedLu one, other;
    one.analyze(named.matrix.pattern);
    other.analyze(scaled.pattern);
    for (std::size_t i = 0; i < index(n); ++i) {
      b[i] = wanted[i];
      b_scaled[i] = std::ldexp(wanted[i], static_cast<int>(i * 53 % 61));
    }
    ASSERT_TRUE(one.solve(named.matrix.values.data(), b.data(), 1, x.data())) << named.name;
    ASSERT_TRUE(other.solve(scaled.values.data(), b_scaled.data(), 1, x_scaled.data())) << named.name;
    // Errors of x are its residuals times the condition, here below 1e4.
    double largest = 0.0, error = 0.0;
    for (std::size_t j = 0; j < index(n); ++j) {
      largest = std::max(largest, std::fabs(x[j]));
      error = std::max(error, std::fabs(std::ldexp(x_scaled[j], static_cast<int>(j * 37 % 101) - 50) - x[j]));
    }
    EXPECT_LE(error, 1e4 * rounding * largest) << named.name;
  }
}

TEST(PlannedLu, RefusesSingularMatricesAndWhatIsNotFinite) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (double value : {0.0, infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
    SparseMatrix matrix = sfdae_test::sparse_matrix(2, {{0, 0, 1.0}, {0, 1, 1.0}, {1, 1, 1.0}});
    PlannedLu lu;
    lu.analyze(matrix.pattern);
    EXPECT_LE(error_of(lu, matrix, 1, 1), rounding);
    matrix.values.back() = value;
    EXPECT_TRUE(std::isnan(error_of(lu, matrix, 1, 1))) << value;
    EXPECT_TRUE(lu.is_suitable());
    matrix.values.back() = 2.0;
    EXPECT_LE(error_of(lu, matrix, 1, 1), rounding);
  }
}

TEST(PlannedLu, IsOfNoUseForLargeFullMatrices) {
  const SparseMatrix full = sfdae_test::arrow(60, 60), line = sfdae_test::reaction_diffusion(500);
  PlannedLu lu;
  lu.analyze(full.pattern);
  EXPECT_FALSE(lu.plan(full.values.data()));
  EXPECT_FALSE(lu.is_suitable());
  lu.analyze(line.pattern);
  EXPECT_TRUE(lu.plan(line.values.data()));
  EXPECT_LE(lu.operations(), 20u * 500u);
}

}  // namespace

}  // namespace sfdae::core
