// SPDX-License-Identifier: BSD-3-Clause
// Transversals and offsets against their definitions, and against all permutations where these are few.
#include "structure/transversal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "structure/blocks.h"
#include "structure/offsets.h"

namespace sfdae::core {

namespace {

using Rows = std::vector<std::vector<Signature::Entry>>;

Rows random_rows(std::mt19937& generator, int n, int most_entries, int highest_order) {
  std::uniform_int_distribution<int> unknown(0, n - 1), count(1, most_entries), order(0, highest_order);
  Rows rows(index(n));
  for (auto& row : rows) {
    std::set<int> taken;
    for (int k = count(generator); k > 0; --k) taken.insert(unknown(generator));
    for (int j : taken) row.push_back({j, order(generator)});
  }
  return rows;
}

// With an entry of each row on a permutation, so that there is a transversal.
Rows solvable_rows(std::mt19937& generator, int n, int most_entries, int highest_order) {
  Rows rows = random_rows(generator, n, most_entries, highest_order);
  std::vector<int> permutation(index(n));
  std::iota(permutation.begin(), permutation.end(), 0);
  std::shuffle(permutation.begin(), permutation.end(), generator);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int j = permutation[i];
    const auto is_there = [j](const Signature::Entry& entry) { return entry.unknown == j; };
    if (std::none_of(rows[i].begin(), rows[i].end(), is_there)) rows[i].push_back({j, 0});
  }
  return rows;
}

int order_at(const Signature& signature, int i, int j) {
  for (const Signature::Entry& entry : signature.row(i))
    if (entry.unknown == j) return entry.order;
  return -1;
}

// The largest sum of orders over all permutations; none if each meets a place without entry.
std::optional<int> largest_value(const Signature& signature) {
  std::vector<int> permutation(index(signature.size()));
  std::iota(permutation.begin(), permutation.end(), 0);
  std::optional<int> largest;
  do {
    int sum = 0;
    bool exists = true;
    for (int i = 0; i < signature.size() && exists; ++i) {
      const int order = order_at(signature, i, permutation[index(i)]);
      exists = order >= 0;
      sum += order;
    }
    if (exists) largest = std::max(largest.value_or(sum), sum);
  } while (std::next_permutation(permutation.begin(), permutation.end()));
  return largest;
}

int value_of(const Signature& signature, const Transversal& transversal) {
  int sum = 0;
  for (int i = 0; i < signature.size(); ++i) sum += order_at(signature, i, transversal.unknown_of[index(i)]);
  return sum;
}

void expect_overdetermined(const Signature& signature, const Overdetermined& part) {
  EXPECT_GT(part.equations.size(), part.unknowns.size());
  for (int i : part.equations)
    for (const Signature::Entry& entry : signature.row(i))
      EXPECT_TRUE(std::binary_search(part.unknowns.begin(), part.unknowns.end(), entry.unknown))
          << i << " " << entry.unknown;
}

// The inequalities with equality on the transversal prove that its value is the largest, and that of the dual problem.
void expect_valid(const Signature& signature, const Transversal& transversal, const Offsets& offsets) {
  for (int i = 0; i < signature.size(); ++i) {
    EXPECT_GE(offsets.c[index(i)], 0);
    EXPECT_EQ(transversal.equation_of[index(transversal.unknown_of[index(i)])], i);
    for (const Signature::Entry& entry : signature.row(i)) {
      EXPECT_GE(offsets.d[index(entry.unknown)] - offsets.c[index(i)], entry.order);
      if (transversal.unknown_of[index(i)] == entry.unknown) {
        EXPECT_TRUE(offsets.is_leading(i, entry));
      }
    }
  }
}

// Lowering any one of them alone breaks an inequality or equality: c = 0, or the equation assigned forbids it. Smallest
// solutions have, for every equation with c_i > 0, a chain of equalities that ends where d_j = sigma_ij, c_i = 0.
void expect_smallest(const Signature& signature, const Transversal& transversal, const Offsets& offsets) {
  std::vector<char> is_held(index(signature.size()));
  bool grows = true;
  const auto holds = [&](int j) {
    for (int i = 0; i < signature.size(); ++i)
      for (const Signature::Entry& entry : signature.row(i))
        if (entry.unknown == j && offsets.is_leading(i, entry) && is_held[index(i)] != 0 &&
            transversal.unknown_of[index(i)] != j)
          return true;
    return false;
  };
  for (int i = 0; i < signature.size(); ++i) is_held[index(i)] = offsets.c[index(i)] == 0;
  while (grows) {
    grows = false;
    for (int i = 0; i < signature.size(); ++i)
      if (is_held[index(i)] == 0 && holds(transversal.unknown_of[index(i)])) is_held[index(i)] = 1, grows = true;
  }
  for (char held : is_held) EXPECT_NE(held, 0);
}

}  // namespace

TEST(Transversal, HasTheLargestValueOfAllPermutations) {
  std::mt19937 generator(1);
  int existing = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    SCOPED_TRACE(trial);
    const int n = 1 + trial % 6;
    const Signature signature(random_rows(generator, n, 4, 1 + trial % 3));
    const Transversal transversal = highest_transversal(signature);
    const std::optional<int> largest = largest_value(signature);
    ASSERT_EQ(transversal.exists(), largest.has_value());
    if (!largest) {
      expect_overdetermined(signature, transversal.overdetermined);
      continue;
    }
    ++existing;
    EXPECT_EQ(value_of(signature, transversal), *largest);
    const Offsets offsets = canonical_offsets(signature, transversal);
    expect_valid(signature, transversal, offsets);
    expect_smallest(signature, transversal, offsets);
    EXPECT_EQ(offsets.freedom(), *largest);
  }
  EXPECT_GT(existing, 500);
}

TEST(Transversal, IsProvedByOffsetsWhereThereAreManyEquations) {
  std::mt19937 generator(2);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const Signature signature(solvable_rows(generator, 20 + 7 * (trial % 20), 6, trial % 4));
    const Transversal transversal = highest_transversal(signature);
    ASSERT_TRUE(transversal.exists());
    const Offsets offsets = canonical_offsets(signature, transversal);
    expect_valid(signature, transversal, offsets);
    EXPECT_EQ(offsets.freedom(), value_of(signature, transversal));
  }
}

TEST(Transversal, NamesEquationsThatAreTooMany) {
  std::mt19937 generator(4);
  int missing = 0;
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const Signature signature(random_rows(generator, 20 + 7 * (trial % 20), 6, trial % 4));
    const Transversal transversal = highest_transversal(signature);
    if (transversal.exists()) continue;
    ++missing;
    expect_overdetermined(signature, transversal.overdetermined);
  }
  EXPECT_GT(missing, 100);
}

TEST(Transversal, NamesAnEquationWithoutUnknowns) {
  const Transversal transversal = highest_transversal(Signature(Rows{{{0, 1}}, {}}));
  EXPECT_EQ(transversal.overdetermined.equations, std::vector<int>{1});
  EXPECT_TRUE(transversal.overdetermined.unknowns.empty());
}

// x' = u, y' = v, u' = -l x, v' = -l y - 1, x^2 + y^2 = 1: known from the literature [P01].
TEST(Offsets, OfThePendulumAreThoseOfTheLiterature) {
  const Signature signature(
      Rows{{{0, 1}, {2, 0}}, {{1, 1}, {3, 0}}, {{2, 1}, {4, 0}, {0, 0}}, {{3, 1}, {4, 0}, {1, 0}}, {{0, 0}, {1, 0}}});
  const Offsets offsets = canonical_offsets(signature, highest_transversal(signature));
  EXPECT_EQ(offsets.c, (std::vector<int>{1, 1, 0, 0, 2}));
  EXPECT_EQ(offsets.d, (std::vector<int>{2, 2, 1, 1, 0}));
  EXPECT_EQ(offsets.freedom(), 2);
  EXPECT_EQ(offsets.index_bound(), 2);
}

TEST(Offsets, OfOrdinaryDifferentialEquationsAskForNoDifferentiation) {
  const Signature signature(Rows{{{0, 1}, {1, 0}}, {{1, 1}, {0, 0}}});
  const Offsets offsets = canonical_offsets(signature, highest_transversal(signature));
  EXPECT_EQ(offsets.c, (std::vector<int>{0, 0}));
  EXPECT_EQ(offsets.index_bound(), 0);
}

// Every block needs what blocks before it determine only, and is connected: its equations reach each other.
TEST(Blocks, AreTriangularAndCannotBeSplit) {
  std::mt19937 generator(3);
  int several = 0;
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    const int n = 2 + trial % 9;
    const Signature signature(solvable_rows(generator, n, 3, 2));
    const Transversal transversal = highest_transversal(signature);
    const Offsets offsets = canonical_offsets(signature, transversal);
    const Blocks blocks(signature, transversal, offsets);
    std::vector<std::vector<char>> reaches(index(n), std::vector<char>(index(n)));
    for (int i = 0; i < n; ++i) {
      reaches[index(i)][index(i)] = 1;
      for (const Signature::Entry& entry : signature.row(i))
        if (offsets.is_leading(i, entry)) reaches[index(i)][index(transversal.equation_of[index(entry.unknown)])] = 1;
    }
    for (std::size_t k = 0; k < index(n); ++k)
      for (std::size_t i = 0; i < index(n); ++i)
        for (std::size_t j = 0; j < index(n); ++j)
          if (reaches[i][k] != 0 && reaches[k][j] != 0) reaches[i][j] = 1;
    std::vector<int> block_of(index(n), -1);
    for (int b = 0; b < blocks.count(); ++b)
      for (int i : blocks.equations(b)) block_of[index(i)] = b;
    for (std::size_t i = 0; i < index(n); ++i)
      for (std::size_t j = 0; j < index(n); ++j) {
        const bool together = reaches[i][j] != 0 && reaches[j][i] != 0;
        EXPECT_EQ(block_of[i] == block_of[j], together);
        if (reaches[i][j] != 0) {
          EXPECT_LE(block_of[j], block_of[i]);
        }
      }
    if (blocks.count() > 1 && blocks.largest() > 1) ++several;
  }
  EXPECT_GT(several, 30);
}

}  // namespace sfdae::core
