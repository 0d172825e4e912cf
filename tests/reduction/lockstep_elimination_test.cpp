// SPDX-License-Identifier: BSD-3-Clause
// Values stay put relative to themselves when data are perturbed, errors move: ranks that do not depend on units.
#include "reduction/lockstep_elimination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include "linalg/random.h"
#include "reduction/known_rank_elimination.h"

namespace sfdae::core {

namespace {

using Rows = std::vector<std::vector<double>>;

LockstepMatrix perturbed(const Rows& rows) {
  std::minstd_rand generator(3);
  LockstepMatrix matrix(static_cast<int>(rows.size()), static_cast<int>(rows[0].size()));
  for (int i = 0; i < matrix.rows(); ++i)
    for (int j = 0; j < matrix.cols(); ++j) {
      const double value = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      matrix.at(i, j) = value;
      for (int k = 1; k < LockstepMatrix::versions; ++k)
        matrix.at(i, j, k) = value * (1.0 + trial_perturbation * symmetric_random(generator));
    }
  return matrix;
}

struct Found {
  int rank;
  Significance significance;
};

Found eliminated(const Rows& rows) {
  LockstepMatrix matrix = perturbed(rows);
  Found found{};
  found.rank = matrix.eliminate(matrix.cols(), found.significance);
  return found;
}

}  // namespace

// An entry of 1e-30 that stands alone is as certain as one of 1.
TEST(LockstepElimination, ExactSmallEntriesAreValues) {
  const Found found = eliminated({{1.0, 0.0}, {1.0, 1e-30}});
  EXPECT_EQ(found.rank, 2);
  EXPECT_TRUE(found.significance.is_clear());
  EXPECT_GE(found.significance.weakest, 1.0 / trial_perturbation / 10.0);
}

// 1 1; 1 1+h: the determinant h vanishes when entries change by h / 4 of themselves.
TEST(LockstepElimination, DifferencesAreValuesAboveThePerturbationAndErrorsBelow) {
  for (double h : {1e-3, 1e-6, 1e-10}) {
    const Found found = eliminated({{1.0, 1.0}, {1.0, 1.0 + h}});
    EXPECT_EQ(found.rank, 2) << h;
    EXPECT_TRUE(found.significance.is_clear()) << h;
    EXPECT_GE(found.significance.weakest, h / trial_perturbation / 4.0);
    EXPECT_LE(found.significance.weakest, h / trial_perturbation * 4.0);
  }
  for (double h : {0.0, 4e-16, 1e-15}) {
    const Found found = eliminated({{1.0, 1.0}, {1.0, 1.0 + h}});
    EXPECT_EQ(found.rank, 1) << h;
    EXPECT_TRUE(found.significance.is_clear()) << h;
  }
  EXPECT_FALSE(eliminated({{1.0, 1.0}, {1.0, 1.0 + 2e-12}}).significance.is_clear());
}

// Rows that depend on each other in exact arithmetic, with entries that leave rounding errors: 0.1 + 0.2 - 0.3.
TEST(LockstepElimination, RoundingErrorsOfSumsAreNoValues) {
  const Found found = eliminated({{0.1, 0.7, 0.3}, {0.2, 1.4, 0.6}, {0.3, 2.1, 0.9}, {0.1, 0.4, 0.3}});
  EXPECT_EQ(found.rank, 2);
  EXPECT_TRUE(found.significance.is_clear());
}

TEST(LockstepElimination, UnitsOfRowsAndColumnsChangeNothing) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> entry(-1.0, 1.0), exponent(-60.0, 60.0);
  for (int trial = 0; trial < 50; ++trial) {
    // Rank 3 of 5 x 5.
    Rows left(5, std::vector<double>(3)), right(3, std::vector<double>(5)), product(5, std::vector<double>(5, 0.0));
    for (auto* factor : {&left, &right})
      for (auto& row : *factor)
        for (double& value : row) value = entry(random);
    for (std::size_t i = 0; i < 5; ++i)
      for (std::size_t j = 0; j < 5; ++j)
        for (std::size_t k = 0; k < 3; ++k) product[i][j] += left[i][k] * right[k][j];
    const Found before = eliminated(product);
    EXPECT_EQ(before.rank, 3);
    for (auto& row : product) {
      const double unit = std::exp2(std::round(exponent(random)));
      for (double& value : row) value *= unit;
    }
    for (std::size_t j = 0; j < 5; ++j) {
      const double unit = std::exp2(std::round(exponent(random)));
      for (auto& row : product) row[j] *= unit;
    }
    const Found after = eliminated(product);
    EXPECT_EQ(after.rank, 3);
    EXPECT_EQ(after.significance.is_clear(), before.significance.is_clear());
  }
}

// The third row is three times the second less two times the first: the pivot h takes errors of 1e-12 to 1e-12 / h in
// the rest, where a value of 1e-4 would not be seen.
TEST(LockstepElimination, ZerosThatMayHideValuesAreNotClear) {
  const double h = 1e-9;
  LockstepMatrix matrix = perturbed({{1.0, 1.0, 0.0}, {1.0, 1.0 + h, 1.0}, {1.0, 1.0 + 3.0 * h, 3.0}});
  Significance significance;
  EXPECT_EQ(matrix.eliminate(2, significance), 2);
  EXPECT_GE(significance.amplification, 0.01 / h);
  EXPECT_FALSE(significance.is_clear());
}

// Columns beside those eliminated are carried along.
TEST(LockstepElimination, CarriesTheRest) {
  LockstepMatrix matrix = perturbed({{2.0, 0.0, 1.0}, {4.0, 0.0, 5.0}});
  Significance significance;
  ASSERT_EQ(matrix.eliminate(2, significance), 1);
  // [2 0 | 1], then [4 0 | 5] - 2 [2 0 | 1], or the other way round: -1/2 of that.
  const double rest = matrix.at(1, 2);
  EXPECT_TRUE(rest == 3.0 || rest == -1.5) << rest;
}

namespace {

// Of this rank, with rows that differ by up to 1e6.
Rows random_rows(int rows, int cols, int rank, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> entry(-1.0, 1.0), exponent(-10.0, 10.0);
  Rows product;
  Rows right(static_cast<std::size_t>(rank), std::vector<double>(static_cast<std::size_t>(cols)));
  for (auto& row : right)
    for (double& value : row) value = entry(random);
  for (int i = 0; i < rows; ++i) {
    product.emplace_back(static_cast<std::size_t>(cols), 0.0);
    const double unit = std::exp2(std::round(exponent(random)));
    for (const auto& row : right) {
      const double factor = unit * entry(random);
      for (std::size_t j = 0; j < row.size(); ++j) product.back()[j] += factor * row[j];
    }
  }
  return product;
}

}  // namespace

// Groups of eight rows, whole and not: what is left of the rows behind the rank of the first columns has the rest of
// it.
TEST(LockstepElimination, FindsRanksOfLargeMatricesInParts) {
  for (int rows : {7, 8, 9, 31, 40})
    for (int width : {3, 12}) {
      const int rank = std::min(rows, 21) - 2, cols = 30;
      LockstepMatrix matrix = perturbed(random_rows(rows, cols, rank, static_cast<unsigned>(rows + width)));
      Significance significance;
      const int first = matrix.eliminate(width, significance);
      EXPECT_EQ(first, std::min(width, rank));
      LockstepMatrix rest(rows - first, cols - width);
      for (int i = 0; i < rest.rows(); ++i)
        for (int j = 0; j < rest.cols(); ++j)
          for (int k = 0; k < LockstepMatrix::versions; ++k) rest.at(i, j, k) = matrix.at(first + i, width + j, k);
      rest.normalize_rows();
      EXPECT_EQ(rest.eliminate(rest.cols(), significance), rank - first) << rows << ", " << width;
      EXPECT_TRUE(significance.is_clear()) << rows << ", " << width;
    }
}

namespace {

// Rows from `top` and columns from `first` on.
LockstepMatrix rest_of(const LockstepMatrix& matrix, int top, int first) {
  LockstepMatrix rest(matrix.rows() - top, matrix.cols() - first);
  for (int i = 0; i < rest.rows(); ++i)
    for (int j = 0; j < rest.cols(); ++j)
      for (int k = 0; k < LockstepMatrix::versions; ++k) rest.at(i, j, k) = matrix.at(top + i, first + j, k);
  rest.normalize_rows();
  return rest;
}

Significance with_rank(const Rows& rows, int width, int rank) {
  LockstepMatrix matrix = perturbed(rows);
  Significance significance;
  eliminate_with_rank(matrix, width, rank, significance);
  return significance;
}

}  // namespace

// A rank that is suggested is confirmed where it is right, in all parts, and in doubt where it is too small or too
// large.
TEST(KnownRankElimination, ConfirmsRightRanksAlone) {
  for (int rows : {7, 16, 40, 70})
    for (int width : {3, 12, 33}) {
      const int rank = std::min(rows, 51) - 2, cols = 60, first = std::min(width, rank);
      const Rows product = random_rows(rows, cols, rank, static_cast<unsigned>(rows + width));
      LockstepMatrix matrix = perturbed(product);
      Significance significance;
      eliminate_with_rank(matrix, width, first, significance);
      EXPECT_TRUE(significance.is_clear()) << rows << ", " << width;
      LockstepMatrix rest = rest_of(matrix, first, width), searched = rest;
      Significance of_rest, of_search;
      eliminate_with_rank(rest, rest.cols(), rank - first, of_rest);
      EXPECT_TRUE(of_rest.is_clear()) << rows << ", " << width;
      EXPECT_EQ(searched.eliminate(searched.cols(), of_search), rank - first) << rows << ", " << width;
      EXPECT_FALSE(with_rank(product, cols, rank - 1).is_clear()) << rows << ", " << width;
      EXPECT_FALSE(with_rank(product, cols, rank + 1).is_clear()) << rows << ", " << width;
      EXPECT_FALSE(with_rank(product, width, width + 1).is_clear()) << rows << ", " << width;
    }
}

// What norms do not see: an entry of 1e-30 that stands alone, and 1e-14 times 1e-14 behind a chain of eliminations.
TEST(KnownRankElimination, SeesExactSmallValues) {
  const Rows alone = {{1.0, 0.0}, {1.0, 1e-30}};
  EXPECT_TRUE(with_rank(alone, 2, 2).is_clear());
  EXPECT_FALSE(with_rank(alone, 2, 1).is_clear());
  const double s = 1e-14;
  const Rows chain = {{1.0, -s, 0.0}, {0.0, 1.0, -s}, {1.0, 0.0, 0.0}};
  EXPECT_TRUE(with_rank(chain, 3, 3).is_clear());
  EXPECT_FALSE(with_rank(chain, 3, 2).is_clear());
}

// The columns beside stay where they are, above and below, and rows without values become zero.
TEST(KnownRankElimination, CarriesTheRest) {
  LockstepMatrix matrix = perturbed({{2.0, 0.0, 1.0}, {4.0, 0.0, 5.0}, {0.4, 0.0, 0.5}});
  Significance significance;
  eliminate_with_rank(matrix, 2, 1, significance);
  EXPECT_EQ(matrix.at(0, 0), 4.0);
  EXPECT_EQ(matrix.at(0, 2), 5.0);
  std::vector<double> rest = {matrix.at(1, 2), matrix.at(2, 2)};
  std::sort(rest.begin(), rest.end());
  EXPECT_EQ(rest, (std::vector<double>{-1.5, 0.0}));
  for (int k = 0; k < LockstepMatrix::versions; ++k) EXPECT_EQ(matrix.at(1, 2, k) * matrix.at(2, 2, k), 0.0);
}

TEST(LockstepElimination, InstructionSetsGiveTheSameBits) {
  if (best_instruction_set() == InstructionSet::portable) GTEST_SKIP() << "there is one alone";
  const InstructionSet usual = instruction_set_of_lanes();
  std::vector<LockstepMatrix> results;
  std::vector<Significance> found;
  for (InstructionSet set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
    if (set > best_instruction_set()) continue;
    use_for_lanes(set);
    LockstepMatrix matrix = perturbed(random_rows(29, 35, 17, 4));
    Significance significance;
    matrix.eliminate(20, significance);
    results.push_back(std::move(matrix));
    found.push_back(significance);
  }
  use_for_lanes(usual);
  for (std::size_t set = 1; set < results.size(); ++set) {
    for (int i = 0; i < 29; ++i)
      for (int j = 0; j < 35; ++j)
        for (int k = 0; k < LockstepMatrix::versions; ++k)
          ASSERT_EQ(results[0].at(i, j, k), results[set].at(i, j, k)) << i << ", " << j;
    EXPECT_EQ(found[0].weakest, found[set].weakest);
    EXPECT_EQ(found[0].strongest, found[set].strongest);
    EXPECT_EQ(found[0].amplification, found[set].amplification);
  }
}

// Zeros of the first columns are measured by these alone if asked for: a large entry beside them hides nothing.
TEST(LockstepElimination, MeasuresZerosByWhatIsAskedFor) {
  const Rows rows = {{1.0, 0.3, 0.0}, {1.0, 0.3, 1e6}};
  Significance whole, alone;
  LockstepMatrix matrix = perturbed(rows);
  matrix.eliminate(2, whole);
  matrix = perturbed(rows);
  matrix.eliminate(2, alone, 0.0, ZeroScale::eliminated_columns);
  EXPECT_GE(alone.amplification, 1e5 * whole.amplification);
}

// Once sizes overflow nothing is clear any more.
TEST(LockstepElimination, OverflowIsNotClear) {
  if (std::getenv("SFDAE_TEST_FPE_TRAPS") != nullptr) GTEST_SKIP() << "overflows on purpose";
  LockstepMatrix matrix = perturbed({{1e-200, 1e200}, {1.0, 1.0}});
  matrix.at(0, 1) = 1e308;
  matrix.at(1, 1) = 1e308;
  for (int k = 0; k < LockstepMatrix::versions; ++k) matrix.at(1, 0, k) = -1e-190 * (1.0 + 0.2 * k);
  Significance significance;
  matrix.eliminate(1, significance);
  EXPECT_FALSE(significance.is_clear());
}

}  // namespace sfdae::core
