// SPDX-License-Identifier: BSD-3-Clause
// Factorizations that are kept: the same bits as others, and never those of another matrix.
#include "linalg/kept_factorizations.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "linalg/dense.h"
#include "linalg/random.h"

namespace sfdae::core {

namespace {

Matrix random_matrix(int rows, int cols, unsigned seed) {
  std::minstd_rand generator(seed);
  Matrix result(rows, cols);
  for (int j = 0; j < cols; ++j)
    for (int i = 0; i < rows; ++i) result(i, j) = symmetric_random(generator);
  return result;
}

// The columns from `rank` on are sums of those before.
Matrix deficient(int rows, int cols, int rank, unsigned seed) {
  return product(random_matrix(rows, rank, seed), random_matrix(rank, cols, seed + 1));
}

struct Factors {
  Matrix a, q;
  std::vector<int> pivots;
  std::vector<double> tau;
  Factors(int rows, int cols) : a(rows, cols), q(rows, rows), pivots(index(cols)), tau(index(std::min(rows, cols))) {}
};

constexpr double negligible = 1e-13;

Factors plain(const Matrix& A, int count, Arena& arena) {
  Factors made(A.rows(), A.cols());
  copy(A, made.a);
  factor_qr_pivoted(made.a, made.pivots.data(), made.tau.data(), arena, negligible);
  form_q(made.a, count, made.tau.data(), made.q, arena);
  return made;
}

Factors kept(KeptFactorizations& factorizations, const Matrix& A, int count, Arena& arena) {
  Factors made(A.rows(), A.cols());
  factorizations.factor(A, negligible, made.a, made.pivots.data(), made.tau.data(), arena);
  factorizations.form_q(made.a, count, made.tau.data(), made.q, arena);
  return made;
}

bool are_same_bits(const Matrix& a, const Matrix& b) {
  return std::memcmp(a.data(), b.data(), index(a.rows()) * index(a.cols()) * sizeof(double)) == 0;
}

void expect_same(const Factors& found, const Factors& wanted) {
  EXPECT_TRUE(are_same_bits(found.a, wanted.a));
  EXPECT_TRUE(are_same_bits(found.q, wanted.q));
  EXPECT_EQ(found.pivots, wanted.pivots);
  EXPECT_EQ(found.tau, wanted.tau);
}

}  // namespace

TEST(KeptFactorizations, AreThoseOfTheMatrixInEveryBit) {
  Arena arena, memory;
  for (int n : {1, 3, 12, 13, 40, 70}) {
    KeptFactorizations factorizations;
    factorizations.start_keeping(memory);
    const int rank = (n + 1) / 2;
    const Matrix A = deficient(n, n, rank, 7), B = random_matrix(n + 2, n, 9);
    for (int repetition = 0; repetition < 3; ++repetition) {
      expect_same(kept(factorizations, A, rank, arena), plain(A, rank, arena));
      expect_same(kept(factorizations, B, n, arena), plain(B, n, arena));
    }
    // Another number of reflections is another Q.
    expect_same(kept(factorizations, A, rank - 1, arena), plain(A, rank - 1, arena));
  }
}

TEST(KeptFactorizations, KnowEveryEntry) {
  Arena arena, memory;
  KeptFactorizations factorizations;
  factorizations.start_keeping(memory);
  const int n = 17;
  const Matrix A = random_matrix(n, n, 3);
  kept(factorizations, A, n, arena);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      Matrix changed(A);
      changed(i, j) *= 1.0 + 0x1p-52;
      Factors found(n, n);
      EXPECT_FALSE(factorizations.find_first(changed, n, found.a, found.pivots.data(), found.tau.data()));
    }
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Matrix B = random_matrix(n, n, seed + 4);
    expect_same(kept(factorizations, B, n, arena), plain(B, n, arena));
  }
  expect_same(kept(factorizations, A, n, arena), plain(A, n, arena));
}

TEST(KeptFactorizations, AreNotThoseOfAnotherThreshold) {
  Arena arena, memory;
  KeptFactorizations factorizations;
  factorizations.start_keeping(memory);
  const int n = 20, rank = 8;
  const Matrix A = deficient(n, n, rank, 5);
  kept(factorizations, A, rank, arena);
  Factors found(n, n), wanted(n, n);
  factorizations.factor(A, -1.0, found.a, found.pivots.data(), found.tau.data(), arena);
  copy(A, wanted.a);
  factor_qr_pivoted(wanted.a, wanted.pivots.data(), wanted.tau.data(), arena);
  EXPECT_TRUE(are_same_bits(found.a, wanted.a));
}

TEST(KeptFactorizations, HaveFirstReflectionsForAnyThreshold) {
  Arena arena, memory;
  KeptFactorizations factorizations;
  factorizations.start_keeping(memory);
  const int n = 20, rank = 8;
  const Matrix A = deficient(n, n, rank, 5);
  const Factors wanted = kept(factorizations, A, rank, arena);
  Factors found(n, n);
  ASSERT_TRUE(factorizations.find_first(A, rank, found.a, found.pivots.data(), found.tau.data()));
  EXPECT_TRUE(are_same_bits(found.a, wanted.a));
  EXPECT_EQ(found.tau, wanted.tau);
  // It ended at the rank.
  EXPECT_FALSE(factorizations.find_first(A, rank + 1, found.a, found.pivots.data(), found.tau.data()));
}

TEST(KeptFactorizations, AreForgotten) {
  Arena arena, memory;
  KeptFactorizations factorizations;
  EXPECT_FALSE(factorizations.is_keeping());
  factorizations.start_keeping(memory);
  EXPECT_TRUE(factorizations.is_keeping());
  const Matrix A = random_matrix(6, 6, 3);
  kept(factorizations, A, 6, arena);
  factorizations.stop_keeping();
  EXPECT_FALSE(factorizations.is_keeping());
  Factors found(6, 6);
  EXPECT_FALSE(factorizations.find_first(A, 6, found.a, found.pivots.data(), found.tau.data()));
}

}  // namespace sfdae::core
