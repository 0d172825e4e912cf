// SPDX-License-Identifier: BSD-3-Clause
// Determinants from the factors of all methods, in any order of rows and columns: those of plain elimination.
#include "linalg/determinant.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

#include "linalg/random.h"
#include "linalg/small_determinant.h"
#include "linalg/sparse_lu.h"
#include "sparse_matrices.h"

namespace sfdae::core {

namespace {

using Complex = std::complex<double>;
using sfdae_test::SparseMatrix;

// With exchanges of rows for the largest pivots; full matrices.
template <class Number>
Determinant<Number> by_elimination(const SparsePattern& pattern, const std::vector<Number>& values) {
  const std::size_t n = index(pattern.size);
  std::vector<std::vector<Number>> a(n, std::vector<Number>(n, Number(0)));
  for (std::size_t j = 0; j < n; ++j)
    for (int k = pattern.first[j]; k < pattern.first[j + 1]; ++k)
      a[index(pattern.row[index(k)])][j] = values[index(k)];
  Determinant<Number> determinant;
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    determinant.change_sign_if(pivot != k);
    std::swap(a[pivot], a[k]);
    determinant.multiply(a[k][k]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const Number factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  return determinant;
}

SparseMatrix shuffled(const SparseMatrix& matrix, unsigned seed) {
  std::minstd_rand generator(seed);
  std::vector<int> rows(index(matrix.pattern.size)), columns;
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<int>(i);
  columns = rows;
  std::shuffle(rows.begin(), rows.end(), generator);
  std::shuffle(columns.begin(), columns.end(), generator);
  return sfdae_test::permuted(matrix, rows, columns);
}

template <class Number>
void expect_determinants(const SparseMatrix& matrix) {
  std::minstd_rand generator(7);
  std::vector<SparseMethod> methods = {SparseMethod::dense, SparseMethod::band};
  if (klu_is_available()) methods.push_back(SparseMethod::klu);
  for (const SparseMethod method : methods) {
    SparseLu<Number> lu;
    lu.analyze(matrix.pattern, method);
    // The second time pivots are known.
    for (int trial = 0; trial < 3; ++trial) {
      std::vector<Number> values(matrix.values.begin(), matrix.values.end());
      for (Number& value : values) {
        value *= 1.0 + 0.5 * trial * symmetric_random(generator);
        if constexpr (std::is_same_v<Number, Complex>) value *= std::polar(1.0, symmetric_random(generator));
      }
      ASSERT_TRUE(lu.factor(values.data()));
      const Determinant<Number> expected = by_elimination(matrix.pattern, values), found = lu.determinant();
      EXPECT_NEAR(std::abs(found.direction - expected.direction), 0.0, 1e-9);
      EXPECT_NEAR(found.log2, expected.log2, 1e-9 * (1.0 + std::fabs(expected.log2)));
    }
  }
}

}  // namespace

TEST(Determinant, IsThatOfTheMatrixWhateverTheMethod) {
  for (unsigned seed = 0; seed < 12; ++seed)
    for (const SparseMatrix& matrix :
         {sfdae_test::reaction_diffusion(12), sfdae_test::laplacian(5, 4), sfdae_test::flow(3),
          sfdae_test::arrow(20, 2), sfdae_test::random_sparse(25, 2, 6), sfdae_test::random_band(30, 2, 4, 0.5, 4),
          sfdae_test::sparse_matrix(2, {{0, 1, 3.0}, {1, 0, -2.0}})}) {
      expect_determinants<double>(shuffled(matrix, seed + 1));
      expect_determinants<Complex>(shuffled(matrix, seed + 1));
    }
}

// 1e-200^400 is far below the smallest number.
TEST(Determinant, DoesNotVanishByUnits) {
  std::vector<sfdae_test::Triplet> entries;
  for (int i = 0; i < 400; ++i) entries.push_back({i, i, i % 2 == 0 ? 1e-200 : -1e-200});
  const SparseMatrix matrix = sfdae_test::sparse_matrix(400, entries);
  SparseLu<double> lu;
  lu.analyze(matrix.pattern);
  ASSERT_TRUE(lu.factor(matrix.values.data()));
  EXPECT_EQ(lu.determinant().direction, 1.0);
  EXPECT_NEAR(lu.determinant().log2, 400 * std::log2(1e-200), 1e-6);
}

TEST(Determinant, KnowsOddPermutations) {
  const int identity[] = {0, 1, 2}, swap[] = {1, 0, 2}, cycle[] = {1, 2, 0}, two_swaps[] = {1, 0, 3, 2};
  EXPECT_FALSE(is_odd(identity, 3));
  EXPECT_TRUE(is_odd(swap, 3));
  EXPECT_FALSE(is_odd(cycle, 3));
  EXPECT_FALSE(is_odd(two_swaps, 4));
}

TEST(SmallDeterminant, IsThatOfEliminationInAnyUnits) {
  std::minstd_rand generator(7);
  for (int size = 1; size <= largest_small_determinant; ++size)
    for (int trial = 0; trial < 200; ++trial) {
      SparsePattern pattern;
      pattern.size = size;
      pattern.first.push_back(0);
      std::vector<double> a(index(size) * index(size)), values;
      const double unit = std::ldexp(1.0, trial % 2 == 0 ? 0 : 900);
      for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) {
          a[index(i + j * size)] = symmetric_random(generator) * (i % 2 == 0 ? unit : 1.0 / unit);
          pattern.row.push_back(i);
          values.push_back(a[index(i + j * size)]);
        }
        pattern.first.push_back(static_cast<int>(pattern.row.size()));
      }
      SparseLu<double> lu;
      lu.analyze(pattern);
      ASSERT_TRUE(lu.factor(values.data()));
      const Determinant<double> expected = lu.determinant();
      Determinant<double> determinant;
      ASSERT_TRUE(small_determinant(a.data(), size, determinant));
      EXPECT_EQ(determinant.direction, expected.direction) << size << ' ' << trial;
      EXPECT_NEAR(determinant.log2, expected.log2, 1e-9) << size << ' ' << trial;
    }
}

TEST(SmallDeterminant, SaysWhereThereIsNone) {
  Determinant<double> determinant;
  double proportional[] = {1.0, 2.0, 2.0, 4.0}, empty[] = {1.0, 0.0, 3.0, 0.0},
         infinite[] = {1.0, HUGE_VAL, 0.0, 1.0};
  EXPECT_FALSE(small_determinant(proportional, 2, determinant));
  EXPECT_FALSE(small_determinant(empty, 2, determinant));
  EXPECT_FALSE(small_determinant(infinite, 2, determinant));
}

}  // namespace sfdae::core
