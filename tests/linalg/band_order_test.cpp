// SPDX-License-Identifier: BSD-3-Clause
// Matchings and orders for bands; that factors of a band take memory once.
#include "linalg/band_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <numeric>
#include <random>
#include <vector>

#include "linalg/index.h"
#include "linalg/sparse_lu.h"
#include "replaced_new.h"
#include "sparse_matrices.h"

namespace {

int allocations = 0;

}  // namespace

namespace sfdae::test {

void before_allocation() { ++allocations; }
void before_release(void*) noexcept {}

}  // namespace sfdae::test

namespace sfdae::core {

namespace {

using sfdae_test::SparseMatrix;

SparseMatrix shuffled(const SparseMatrix& matrix, unsigned seed) {
  std::minstd_rand generator(seed);
  std::vector<int> row(index(matrix.pattern.size));
  std::iota(row.begin(), row.end(), 0);
  std::vector<int> column = row;
  std::shuffle(row.begin(), row.end(), generator);
  std::shuffle(column.begin(), column.end(), generator);
  return sfdae_test::permuted(matrix, row, column);
}

bool augment(const SparsePattern& pattern, int j, std::vector<int>& column_of, std::vector<bool>& seen) {
  for (int k = pattern.first[index(j)]; k < pattern.first[index(j) + 1]; ++k) {
    const std::size_t i = index(pattern.row[index(k)]);
    if (seen[i]) continue;
    seen[i] = true;
    if (column_of[i] >= 0 && !augment(pattern, column_of[i], column_of, seen)) continue;
    column_of[i] = j;
    return true;
  }
  return false;
}

// By one augmenting path after the other.
int largest_matching(const SparsePattern& pattern) {
  std::vector<int> column_of(index(pattern.size), -1);
  int size = 0;
  for (int j = 0; j < pattern.size; ++j) {
    std::vector<bool> seen(index(pattern.size));
    if (augment(pattern, j, column_of, seen)) ++size;
  }
  return size;
}

SparsePattern random_pattern(int size, int entries, unsigned seed) {
  std::minstd_rand generator(seed);
  std::vector<sfdae_test::Triplet> triplets;
  for (int k = 0; k < entries; ++k) {
    const int row = static_cast<int>(generator() / 7 % static_cast<unsigned>(size));
    triplets.push_back({row, static_cast<int>(generator() / 7 % static_cast<unsigned>(size)), 1.0});
  }
  return sfdae_test::sparse_matrix(size, triplets).pattern;
}

bool is_permutation(std::vector<int> places) {
  std::sort(places.begin(), places.end());
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i] != static_cast<int>(i)) return false;
  return true;
}

}  // namespace

TEST(MaximumMatching, IsAMatchingOfEntriesAndAsLargeAsPossible) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const int size = 1 + static_cast<int>(seed % 40);
    const SparsePattern pattern = random_pattern(size, size * (1 + static_cast<int>(seed % 4)), seed);
    const std::vector<int> column_of = maximum_matching(pattern);
    std::vector<bool> taken(index(size));
    int matched = 0;
    for (int i = 0; i < size; ++i) {
      const int j = column_of[index(i)];
      if (j < 0) continue;
      ++matched;
      EXPECT_FALSE(taken[index(j)]);
      taken[index(j)] = true;
      const auto begin = pattern.row.begin() + pattern.first[index(j)];
      const auto end = pattern.row.begin() + pattern.first[index(j) + 1];
      EXPECT_TRUE(std::binary_search(begin, end, i));
    }
    EXPECT_EQ(matched, largest_matching(pattern)) << seed;
  }
}

TEST(MaximumMatching, KeepsAFullDiagonal) {
  const std::vector<int> column_of = maximum_matching(sfdae_test::laplacian(5, 4).pattern);
  for (std::size_t i = 0; i < column_of.size(); ++i) EXPECT_EQ(column_of[i], static_cast<int>(i));
}

TEST(BandOrder, FindsBandsAgain) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int lower = static_cast<int>(seed % 4), upper = 1 + static_cast<int>(seed % 3);
    const SparseMatrix matrix = shuffled(sfdae_test::random_band(200, lower, upper, 0.0, seed), seed);
    const BandOrder order = band_order(matrix.pattern, maximum_matching(matrix.pattern));
    EXPECT_TRUE(is_permutation(order.row_place));
    EXPECT_TRUE(is_permutation(order.column_place));
    EXPECT_LE(order.lower, order.upper);
    EXPECT_LE(order.lower + order.upper, 2 * (lower + upper)) << lower << " " << upper;
    for (std::size_t j = 0; j < 200; ++j)
      for (int k = matrix.pattern.first[j]; k < matrix.pattern.first[j + 1]; ++k) {
        const int below = order.row_place[index(matrix.pattern.row[index(k)])] - order.column_place[j];
        EXPECT_LE(below, order.lower);
        EXPECT_LE(-below, order.upper);
      }
  }
}

TEST(BandOrder, OfAShuffledSquareIsItsShorterSide) {
  const SparseMatrix matrix = shuffled(sfdae_test::laplacian(30, 8), 3);
  const BandOrder order = band_order(matrix.pattern, maximum_matching(matrix.pattern));
  EXPECT_LE(order.lower + order.upper, 3 * 8);
}

TEST(BandOrder, OfComponentsIsThatOfTheWidest) {
  std::vector<sfdae_test::Triplet> entries;
  for (int i = 0; i < 50; ++i) entries.push_back({i, i, 1.0});
  entries.push_back({0, 49, 1.0});
  entries.push_back({49, 0, 1.0});
  const SparsePattern pattern = sfdae_test::sparse_matrix(50, entries).pattern;
  const BandOrder order = band_order(pattern, maximum_matching(pattern));
  EXPECT_EQ(order.lower, 1);
  EXPECT_EQ(order.upper, 1);
}

template <class Number>
void expect_no_allocations(SparseMethod method) {
  const SparseMatrix matrix = shuffled(sfdae_test::reaction_diffusion(100), 2);
  const std::vector<Number> values(matrix.values.begin(), matrix.values.end());
  SparseLu<Number> lu;
  lu.analyze(matrix.pattern, method);
  std::vector<Number> b(2 * index(matrix.pattern.size), Number(1.0));
  for (int pass = 0; pass < 3; ++pass) {
    const int before = allocations;
    ASSERT_TRUE(lu.factor(values.data()));
    lu.solve(b.data(), 2);
    lu.solve_transposed(b.data());
    if (pass > 0) {
      EXPECT_EQ(allocations, before);
    }
  }
}

TEST(SparseLu, TakesMemoryOnce) {
  for (const SparseMethod method : {SparseMethod::band, SparseMethod::dense}) {
    expect_no_allocations<double>(method);
    expect_no_allocations<std::complex<double>>(method);
  }
}

}  // namespace sfdae::core
