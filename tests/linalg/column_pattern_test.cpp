// SPDX-License-Identifier: BSD-3-Clause
// Patterns by compressed columns and groups of columns without a common row.
#include "linalg/column_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace sfdae::core {

namespace {

ColumnPattern random_pattern(unsigned seed, int rows, int columns, int most) {
  std::mt19937 generator(seed);
  ColumnPattern pattern;
  for (int j = 0; j < columns; ++j) {
    std::set<int> own;
    for (int k = static_cast<int>(generator() % static_cast<unsigned>(most + 1)); k > 0; --k)
      own.insert(static_cast<int>(generator() % static_cast<unsigned>(rows)));
    pattern.row.insert(pattern.row.end(), own.rbegin(), own.rend());
    pattern.start.push_back(pattern.entries());
  }
  return pattern;
}

bool contains(const ColumnPattern& pattern, int row, int column) {
  const auto first = pattern.row.begin() + pattern.start[index(column)];
  const auto last = pattern.row.begin() + pattern.start[index(column) + 1];
  return std::find(first, last, row) != last;
}

}  // namespace

TEST(ColumnPattern, GroupsHaveEveryColumnOnceAndNoRowTwice) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const int rows = 5 + static_cast<int>(seed % 20), columns = 3 + static_cast<int>(seed % 30);
    const ColumnPattern pattern = random_pattern(seed, rows, columns, 4);
    std::vector<int> seen(index(columns), 0);
    for (const std::vector<int>& group : group_columns(pattern, rows)) {
      std::vector<int> taken(index(rows), 0);
      for (int j : group) {
        ++seen[index(j)];
        for (int e = pattern.start[index(j)]; e < pattern.start[index(j) + 1]; ++e)
          EXPECT_EQ(taken[index(pattern.row[index(e)])]++, 0);
      }
    }
    EXPECT_EQ(seen, std::vector<int>(index(columns), 1));
  }
}

TEST(ColumnPattern, ABandTakesAsManyGroupsAsItIsWide) {
  ColumnPattern band;
  constexpr int n = 50;
  for (int j = 0; j < n; ++j) {
    for (int i = std::max(j - 2, 0); i <= std::min(j + 2, n - 1); ++i) band.row.push_back(i);
    band.start.push_back(band.entries());
  }
  EXPECT_EQ(group_columns(band, n).size(), 5u);
}

TEST(ColumnPattern, AUnionHasTheEntriesOfBothAndNoOthers) {
  constexpr int rows = 9, columns = 12;
  const ColumnPattern a = random_pattern(1, rows, columns, 5), b = random_pattern(2, rows, columns, 5);
  const ColumnPattern both = united(a, b, rows);
  int count = 0;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      EXPECT_EQ(contains(both, i, j), contains(a, i, j) || contains(b, i, j));
      count += contains(both, i, j) ? 1 : 0;
    }
  EXPECT_EQ(both.entries(), count);
}

TEST(ColumnPattern, EntriesGoToAMatrixAndBackAndWhatIsBeyondIsFound) {
  constexpr int rows = 7, columns = 6;
  const ColumnPattern pattern = random_pattern(3, rows, columns, 4);
  std::vector<double> entries(index(pattern.entries())), matrix(rows * columns), back(entries.size());
  for (std::size_t e = 0; e < entries.size(); ++e) entries[e] = 1.0 + static_cast<double>(e);
  scatter(pattern, entries.data(), rows, matrix.data());
  gather(pattern, matrix.data(), rows, back.data());
  EXPECT_EQ(back, entries);
  EXPECT_EQ(entry_beyond(pattern, rows, matrix.data()).row, -1);
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i < rows; ++i) {
      if (contains(pattern, i, j)) continue;
      std::vector<double> changed(matrix);
      changed[index(i + rows * j)] = 1e-300;
      const MatrixEntry found = entry_beyond(pattern, rows, changed.data());
      EXPECT_EQ(found.row, i);
      EXPECT_EQ(found.column, j);
    }
  for (int e = 0; e < pattern.entries(); ++e) {
    const int j = pattern.column_of(e);
    EXPECT_LE(pattern.start[index(j)], e);
    EXPECT_LT(e, pattern.start[index(j) + 1]);
  }
}

}  // namespace sfdae::core
