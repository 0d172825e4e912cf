// The choice of pivots for operations that are listed.
//
// [Z80] Z. Zlatev: On some pivotal strategies in Gaussian elimination by sparse technique. SIAM J. Numer. Anal. 17
// (1980), 18-30.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "linalg/index.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

// The elimination of one matrix, with pivots by Markowitz's count among those that are large enough [Z80].
class EliminationPlanning {
 public:
  struct Entry {
    int column, position;
    double value;
  };
  struct Step {
    int row, column;
    std::vector<int> u_columns, u_positions, l_rows, l_positions;
  };

  EliminationPlanning(const SparsePattern& pattern, const double* scaled)
      : rows_(index(pattern.size)), columns_(index(pattern.size)), place_(index(pattern.size), -1) {
    for (int j = 0; j < pattern.size; ++j) {
      remaining_.push_back(j);
      for (int e = pattern.first[index(j)]; e < pattern.first[index(j) + 1]; ++e) {
        const int i = pattern.row[index(e)];
        rows_[index(i)].push_back({j, e, scaled[e]});
        columns_[index(j)].push_back(i);
      }
    }
    positions_ = static_cast<int>(pattern.row.size());
  }

  // False if no pivot is left, or there are more operations.
  bool run(std::size_t most) {
    while (!remaining_.empty()) {
      if (!find_pivot()) return false;
      eliminate();
      if (targets_.size() > most) return false;
    }
    return true;
  }

  const std::vector<Step>& steps() const { return steps_; }
  const std::vector<int>& targets() const { return targets_; }
  int positions() const { return positions_; }
  int pivot_position(std::size_t k) const { return pivot_positions_[k]; }

 private:
  // Pivots are at least this part of the largest entry of their columns, among the columns with fewest entries.
  static constexpr double threshold = 0.1;
  static constexpr std::size_t columns_searched = 4;

  const Entry& entry(int row, int column) const {
    const std::vector<Entry>& entries = rows_[index(row)];
    return *std::find_if(entries.begin(), entries.end(), [column](const Entry& e) { return e.column == column; });
  }

  bool find_pivot() {
    const std::size_t searched = std::min(columns_searched, remaining_.size());
    std::partial_sort(remaining_.begin(), remaining_.begin() + static_cast<std::ptrdiff_t>(searched),
                      remaining_.end(), [this](int one, int other) {
                        const std::size_t a = columns_[index(one)].size(), b = columns_[index(other)].size();
                        return a != b ? a < b : one < other;
                      });
    double least = std::numeric_limits<double>::infinity(), size = 0.0;
    for (std::size_t k = 0; k < searched; ++k) {
      const std::vector<int>& rows = columns_[index(remaining_[k])];
      double largest = 0.0;
      for (int i : rows) largest = std::max(largest, std::fabs(entry(i, remaining_[k]).value));
      if (largest == 0.0) return false;
      for (int i : rows) {
        const double value = std::fabs(entry(i, remaining_[k]).value);
        if (value < threshold * largest) continue;
        const double cost = static_cast<double>(rows.size() - 1) * static_cast<double>(rows_[index(i)].size() - 1);
        if (cost > least || (cost == least && value <= size)) continue;
        least = cost;
        size = value;
        row_ = i;
        column_ = remaining_[k];
      }
    }
    return true;
  }

  void eliminate() {
    Step step{row_, column_, {}, {}, {}, {}};
    std::vector<Entry> pivot_row = std::move(rows_[index(row_)]);
    rows_[index(row_)].clear();
    const auto pivot =
        std::find_if(pivot_row.begin(), pivot_row.end(), [this](const Entry& e) { return e.column == column_; });
    const double pivot_value = pivot->value;
    pivot_positions_.push_back(pivot->position);
    pivot_row.erase(pivot);
    for (const Entry& e : pivot_row) {
      step.u_columns.push_back(e.column);
      step.u_positions.push_back(e.position);
      std::erase(columns_[index(e.column)], row_);
    }
    for (int i : columns_[index(column_)]) {
      if (i == row_) continue;
      std::vector<Entry>& entries = rows_[index(i)];
      const auto own =
          std::find_if(entries.begin(), entries.end(), [this](const Entry& e) { return e.column == column_; });
      step.l_rows.push_back(i);
      step.l_positions.push_back(own->position);
      const double multiplier = own->value / pivot_value;
      entries.erase(own);
      for (std::size_t k = 0; k < entries.size(); ++k) place_[index(entries[k].column)] = static_cast<int>(k);
      for (const Entry& u : pivot_row) {
        int& place = place_[index(u.column)];
        if (place < 0) {
          place = static_cast<int>(entries.size());
          entries.push_back({u.column, positions_++, 0.0});
          columns_[index(u.column)].push_back(i);
        }
        Entry& target = entries[index(place)];
        target.value -= multiplier * u.value;
        targets_.push_back(target.position);
      }
      for (const Entry& e : entries) place_[index(e.column)] = -1;
    }
    columns_[index(column_)].clear();
    std::erase(remaining_, column_);
    steps_.push_back(std::move(step));
  }

  std::vector<std::vector<Entry>> rows_;   // of the remaining matrix
  std::vector<std::vector<int>> columns_;  // rows with entries there
  std::vector<int> remaining_, place_, pivot_positions_, targets_;
  std::vector<Step> steps_;
  int positions_ = 0, row_ = 0, column_ = 0;
};

}  // namespace sfdae::core
