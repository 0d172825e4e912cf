// Maximum matching of rows and columns: shortest augmenting paths, as many disjoint ones at once as possible [HK73].
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "linalg/band_order.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

constexpr int none = -1;

class Matching {
 public:
  explicit Matching(const SparsePattern& pattern)
      : pattern_(pattern),
        row_of_(index(pattern.size), none),
        column_of_(index(pattern.size), none),
        level_(index(pattern.size)),
        next_(index(pattern.size)) {}

  std::vector<int> run() {
    match_diagonal();
    match_first_free();
    while (set_levels()) {
      std::copy_n(pattern_.first.begin(), next_.size(), next_.begin());
      for (int j = 0; j < pattern_.size; ++j)
        if (row_of_[index(j)] == none) augment_from(j);
    }
    return column_of_;
  }

 private:
  void match(int i, int j) {
    row_of_[index(j)] = i;
    column_of_[index(i)] = j;
  }
  int row(int k) const { return pattern_.row[index(k)]; }
  void match_diagonal();
  void match_first_free();
  bool set_levels();
  void augment_from(int column);

  const SparsePattern& pattern_;
  std::vector<int> row_of_, column_of_;  // each the inverse of the other
  std::vector<int> level_;               // of columns: steps from a column without a row
  std::vector<int> next_;                // of columns: the entry to be tried next
  std::vector<int> queue_, path_;
};

void Matching::match_diagonal() {
  for (int j = 0; j < pattern_.size; ++j) {
    const auto begin = pattern_.row.begin() + pattern_.first[index(j)];
    const auto end = pattern_.row.begin() + pattern_.first[index(j) + 1];
    if (std::binary_search(begin, end, j)) match(j, j);
  }
}

void Matching::match_first_free() {
  for (int j = 0; j < pattern_.size; ++j)
    for (int k = pattern_.first[index(j)]; k < pattern_.first[index(j) + 1] && row_of_[index(j)] == none; ++k)
      if (column_of_[index(row(k))] == none) match(row(k), j);
}

// False if there is no augmenting path.
bool Matching::set_levels() {
  queue_.clear();
  for (int j = 0; j < pattern_.size; ++j) {
    level_[index(j)] = row_of_[index(j)] == none ? 0 : none;
    if (level_[index(j)] == 0) queue_.push_back(j);
  }
  bool found = false;
  for (std::size_t q = 0; q < queue_.size() && !found; ++q) {
    // All columns of the level at which a free row is found have their levels already, or are not needed.
    const int j = queue_[q];
    for (int k = pattern_.first[index(j)]; k < pattern_.first[index(j) + 1]; ++k) {
      const int owner = column_of_[index(row(k))];
      if (owner == none) found = true;
      else if (level_[index(owner)] == none) {
        level_[index(owner)] = level_[index(j)] + 1;
        queue_.push_back(owner);
      }
    }
  }
  return found;
}

// Depth first, without recursion: paths may be as long as the matrix.
void Matching::augment_from(int column) {
  path_.assign(1, column);
  while (!path_.empty()) {
    const int j = path_.back();
    int& k = next_[index(j)];
    if (k == pattern_.first[index(j) + 1]) {
      path_.pop_back();
      if (!path_.empty()) ++next_[index(path_.back())];
      continue;
    }
    const int owner = column_of_[index(row(k))];
    if (owner == none) {
      for (const int passed : path_) match(row(next_[index(passed)]), passed);
      // Columns of the path are exhausted for this phase.
      for (const int passed : path_) next_[index(passed)] = pattern_.first[index(passed) + 1];
      return;
    }
    if (level_[index(owner)] == level_[index(j)] + 1 && next_[index(owner)] < pattern_.first[index(owner) + 1])
      path_.push_back(owner);
    else ++k;
  }
}

}  // namespace

std::vector<int> maximum_matching(const SparsePattern& pattern) { return Matching(pattern).run(); }

}  // namespace sfdae::core
