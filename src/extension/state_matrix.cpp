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
  size_ = slots;
  changed_.clear();
  for (int column = 0; column < extension.num_columns(); ++column) {
    const auto [unknown, order] = extension.columns()[index(column)];
    if (!is_slope(column)) changed_.push_back({column, slot(column), unknown + order * extension.n()});
  }
  list_held_entries(extension);
  layout_ = layout_of(extension, false);
  held_layout_ = layout_of(extension, true);
}

void StateChoice::list_held_entries(const MinimalExtension& extension) {
  // Where all unknowns are states, as those of a discretized field may be, the list would only take memory. Chosen, not measured.
  constexpr std::size_t least_others = 4;
  held_entries_.clear();
  std::size_t count = 0;
  for (int column : extension.column()) count += is_held(column) ? 1 : 0;
  has_held_entries_ = least_others * count <= extension.column().size();
  if (!has_held_entries_) return;
  held_entries_.reserve(count);
  for (int row = 0; row < extension.num_rows(); ++row)
    for (int e = extension.first()[index(row)]; e < extension.first()[index(row + 1)]; ++e) {
      const int column = extension.column()[index(e)];
      if (is_held(column)) held_entries_.push_back({row, extension.columns()[index(column)].unknown, e});
    }
}

// By columns: the rows of each, ascending as rows are gone through in their order; two entries of a row may meet.
StateChoice::Layout StateChoice::layout_of(const MinimalExtension& extension, bool holds_states) const {
  Layout layout;
  SparsePattern& pattern = layout.pattern;
  pattern.size = size_;
  const std::vector<int>& first = extension.first();
  const auto for_each = [&](auto action) {
    for (int row = 0; row < extension.num_rows(); ++row)
      for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
        const int column = extension.column()[index(e)];
        if (!holds_states || !is_held(column)) action(row, e, index(slot(column)));
      }
  };
  std::vector<int> last_row(index(size_), -1), count(index(size_), 0);
  for_each([&](int row, int, std::size_t column) {
    if (last_row[column] != row) ++count[column];
    last_row[column] = row;
  });
  pattern.first.assign(1, 0);
  for (int entries : count) pattern.first.push_back(pattern.first.back() + entries);
  pattern.row.assign(index(pattern.first.back()), 0);
  layout.place.assign(extension.column().size(), -1);
  std::vector<int> next(pattern.first.begin(), pattern.first.end() - 1);
  last_row.assign(index(size_), -1);
  for_each([&](int row, int e, std::size_t column) {
    if (last_row[column] != row) pattern.row[index(next[column]++)] = row;
    last_row[column] = row;
    layout.place[index(e)] = next[column] - 1;
  });
  return layout;
}

}  // namespace sfdae::core
