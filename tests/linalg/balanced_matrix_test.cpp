// SPDX-License-Identifier: BSD-3-Clause
// Matrices whose units explain the sizes of their entries, and others.
#include "linalg/balanced_matrix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sfdae::core {

namespace {

constexpr int n = 5;

Matrix random_matrix(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> size(0.1, 1.0);
  Matrix result(n, n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) result(i, j) = random() % 2 == 0 ? size(random) : -size(random);
  return result;
}

// Rows and columns times powers of two up to 2^+-bits.
void change_units(Matrix& J, unsigned seed, int bits) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> exponent(-bits, bits);
  for (int i = 0; i < n; ++i) {
    const int of_row = exponent(random), of_column = exponent(random);
    for (int j = 0; j < n; ++j) J(i, j) = std::ldexp(J(i, j), of_row);
    for (int j = 0; j < n; ++j) J(j, i) = std::ldexp(J(j, i), of_column);
  }
}

bool is_regular(Matrix J, RankDecision& decision) { return is_regular_in_balanced_units(J, Matrix(n, n), decision); }

}  // namespace

TEST(BalancedMatrix, IsRegularInAllUnits) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Matrix J = random_matrix(seed);
    RankDecision first, second;
    ASSERT_TRUE(is_regular(J, first)) << seed;
    change_units(J, seed, 60);
    ASSERT_TRUE(is_regular(J, second)) << seed;
    EXPECT_EQ(second.rank, n);
    EXPECT_NEAR(std::log2(second.kept / first.kept), 0.0, 4.0) << seed;  // exponents are rounded
  }
}

// Exactly, or but for rounding errors, which powers of two do not add to.
TEST(BalancedMatrix, RowsThatDependOnEachOtherDoSoInAllUnits) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Matrix J = random_matrix(seed);
    for (int j = 0; j < n; ++j) J(n - 1, j) = J(0, j) - 3.0 * J(1, j);
    change_units(J, seed, 60);
    RankDecision decision;
    decision.rank = -1;
    EXPECT_FALSE(is_regular(J, decision)) << seed;
    EXPECT_EQ(decision.rank, -1);
  }
}

// 1e-17 beside entries of size one may be a rounding error of a zero: J has to be regular with it and without.
TEST(BalancedMatrix, NothingDependsOnEntriesThatUnitsDoNotExplain) {
  Matrix J = random_matrix(3), changes(n, n), without_suspects;
  J(2, 1) = 1e-17;
  RankDecision decision;
  EXPECT_TRUE(is_regular(J, decision));
  ASSERT_TRUE(balance(J, changes, without_suspects));
  EXPECT_NE(J(2, 1), 0.0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) EXPECT_EQ(without_suspects(i, j), i == 2 && j == 1 ? 0.0 : J(i, j));
  // Rows 0 and 1 differ by it alone.
  J = random_matrix(3);
  for (int j = 0; j < n; ++j) J(1, j) = J(0, j);
  J(0, 2) = 0.0, J(1, 2) = 1e-9;
  decision.rank = -1;
  EXPECT_FALSE(is_regular(J, decision));
  EXPECT_EQ(decision.rank, -1);
}

TEST(BalancedMatrix, ErrorsOfTheDataCount) {
  Matrix J = random_matrix(4), changes(n, n);
  for (int j = 0; j < n; ++j) J(n - 1, j) = J(0, j) + 1e-6 * J(n - 1, j);
  RankDecision decision;
  EXPECT_TRUE(is_regular(J, decision));
  for (int j = 0; j < n; ++j) changes(0, j) = 1e-8 * J(0, j);
  EXPECT_FALSE(is_regular_in_balanced_units(J, changes, decision));
}

}  // namespace sfdae::core
