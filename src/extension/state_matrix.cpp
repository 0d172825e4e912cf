// The extension as a square sparse matrix.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/state_matrix.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

void StateChoice::set(const MinimalExtension& extension, std::vector<int> states) {
  states_ = std::move(states);
  is_state_.assign(index(extension.n()), 0);
  is_held_.assign(extension.columns().size(), 0);
  is_slope_ = is_held_;
  slot_.assign(extension.columns().size(), -1);
  state_slots_.clear();
  for (int j : states_) {
    is_state_[index(j)] = 1;
    is_held_[index(extension.column_of(j, 0))] = 1;
    is_slope_[index(extension.column_of(j, 1))] = 1;
  }
  int slots = 0;
  for (int column = 0; column < extension.num_columns(); ++column)
    if (!is_held(column)) slot_[index(column)] = slots++;
  for (int j : states_) {
    state_slots_.push_back(slot(extension.column_of(j, 1)));
    slot_[index(extension.column_of(j, 0))] = state_slots_.back();
  }
  pattern_.size = slots;
  make_pattern(extension);
}

// By columns: the rows of each, ascending as rows are gone through in their order; two entries of a row may meet.
void StateChoice::make_pattern(const MinimalExtension& extension) {
  std::vector<std::vector<int>> rows_of(index(pattern_.size));
  const std::vector<int>& first = extension.first();
  for (int row = 0; row < extension.num_rows(); ++row)
    for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
      std::vector<int>& rows = rows_of[index(slot(extension.column()[index(e)]))];
      if (rows.empty() || rows.back() != row) rows.push_back(row);
    }
  pattern_.first.assign(1, 0);
  pattern_.row.clear();
  for (const std::vector<int>& rows : rows_of) {
    pattern_.row.insert(pattern_.row.end(), rows.begin(), rows.end());
    pattern_.first.push_back(static_cast<int>(pattern_.row.size()));
  }
  place_.resize(extension.column().size());
  std::vector<int> next(pattern_.first.begin(), pattern_.first.end() - 1);
  for (int row = 0; row < extension.num_rows(); ++row) {
    for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
      const int column = slot(extension.column()[index(e)]);
      int& at = next[index(column)];
      if (pattern_.row[index(at)] != row) ++at;
      place_[index(e)] = at;
    }
  }
}

}  // namespace sfdae::core
