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
  state_slots_.reserve(states_.size());
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
  changed_.reserve(extension.columns().size() - states_.size());
  for (int column = 0; column < extension.num_columns(); ++column)
    if (!is_slope(column)) changed_.push_back(column);
  list_held_entries(extension);
  lay_out(extension);
  lay_out_held(extension);
}

void StateChoice::list_held_entries(const MinimalExtension& extension) {
  // If all unknowns are states, as for a discretized field, the list would only take memory. Chosen, not measured.
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

namespace {

// action(row, entry, slot) for all entries of the extension, rows in their order; without those left out.
template <class LeavesOut, class Action>
void for_each_entry(const MinimalExtension& extension, const StateChoice& choice, LeavesOut leaves_out,
                    Action action) {
  const std::vector<int>& first = extension.first();
  for (int row = 0; row < extension.num_rows(); ++row)
    for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
      const int column = extension.column()[index(e)];
      if (!leaves_out(column)) action(row, e, index(choice.slot(column)));
    }
}

std::shared_ptr<SparsePattern> pattern_of_columns(const std::vector<int>& count) {
  auto pattern = std::make_shared<SparsePattern>();
  pattern->size = static_cast<int>(count.size());
  pattern->first.reserve(count.size() + 1);
  pattern->first.push_back(0);
  for (int entries : count) pattern->first.push_back(pattern->first.back() + entries);
  pattern->row.assign(index(pattern->first.back()), 0);
  return pattern;
}

}  // namespace

// Pattern by columns; the rows of each ascend, as rows are visited in order. Two entries of a row may coincide.
void StateChoice::lay_out(const MinimalExtension& extension) {
  const auto none = [](int) { return false; };
  std::vector<int> last_row(index(size_), -1), next(index(size_), 0);
  for_each_entry(extension, *this, none, [&](int row, int, std::size_t column) {
    if (last_row[column] != row) ++next[column];
    last_row[column] = row;
  });
  const auto pattern = pattern_of_columns(next);
  std::copy(pattern->first.begin(), pattern->first.end() - 1, next.begin());
  places_.resize(extension.column().size());
  last_row.assign(index(size_), -1);
  for_each_entry(extension, *this, none, [&](int row, int e, std::size_t column) {
    if (last_row[column] != row) pattern->row[index(next[column]++)] = row;
    last_row[column] = row;
    places_[index(e)] = next[column] - 1;
  });
  pattern_ = pattern;
}

void StateChoice::lay_out_held(const MinimalExtension& extension) {
  const auto held = [this](int column) { return is_held(column); };
  std::vector<int> next(index(size_), 0);
  for_each_entry(extension, *this, held, [&](int, int, std::size_t column) { ++next[column]; });
  const auto pattern = pattern_of_columns(next);
  std::copy(pattern->first.begin(), pattern->first.end() - 1, next.begin());
  entries_of_held_.resize(pattern->row.size());
  for_each_entry(extension, *this, held, [&](int row, int e, std::size_t column) {
    const std::size_t place = index(next[column]++);
    pattern->row[place] = row;
    entries_of_held_[place] = e;
  });
  held_pattern_ = pattern;
}

}  // namespace sfdae::core
