// Where a sparse matrix has entries.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

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

}  // namespace sfdae::core
