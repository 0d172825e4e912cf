// Where a sparse matrix has entries.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::core {

// Square, in compressed columns: the entries of column j are first[j], ..., first[j + 1] - 1, in rows that ascend.
struct SparsePattern {
  int size = 0;
  std::vector<int> first;  // size + 1
  std::vector<int> row;
};

}  // namespace sfdae::core
