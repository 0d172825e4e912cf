// Sparsity pattern of a matrix.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

// Square, in compressed columns: the entries of column j are first[j], ..., first[j + 1] - 1, in rows that ascend.
struct SparsePattern {
  int size = 0;
  std::vector<int> first;  // size + 1
  std::vector<int> row;
};

// Columns of rows and values; values: those of all columns, one after the other.
template <class Value>
SparsePattern pattern_of(const std::vector<std::vector<std::pair<int, Value>>>& columns, std::vector<Value>& values) {
  SparsePattern pattern;
  pattern.size = static_cast<int>(columns.size());
  pattern.first.assign(1, 0);
  values.clear();
  for (const auto& column : columns) {
    for (const auto& [row, value] : column) {
      pattern.row.push_back(row);
      values.push_back(value);
    }
    pattern.first.push_back(static_cast<int>(pattern.row.size()));
  }
  return pattern;
}

// Pattern of values that are summed at the places (column, row); positions: index of each among the entries.
inline SparsePattern pattern_of(int size, const std::vector<std::pair<int, int>>& places,
                                std::vector<std::size_t>& positions) {
  std::vector<std::pair<int, int>> sorted = places;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  positions.clear();
  for (const auto& place : places)
    positions.push_back(
        static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), place) - sorted.begin()));
  SparsePattern pattern;
  pattern.size = size;
  pattern.first.assign(index(size) + 1, 0);
  for (const auto& [column, row] : sorted) {
    pattern.row.push_back(row);
    ++pattern.first[index(column) + 1];
  }
  std::partial_sum(pattern.first.begin(), pattern.first.end(), pattern.first.begin());
  return pattern;
}

}  // namespace sfdae::core
