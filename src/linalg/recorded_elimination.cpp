// LU factors of small sparse matrices by a recorded elimination.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/recorded_elimination.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/dense_factors.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Of the largest entry in the row: what a pivot has to be when it is chosen (the usual bound [DER86, 5.4]), and when the
// elimination is repeated, as for lanes (docs/decisions/36-evaluation-of-stages.md).
constexpr double large_enough = 0.1, still_large_enough = 0.01;
constexpr double largest_number = std::numeric_limits<double>::max();

}  // namespace

// The matrix while pivots are being chosen. Entries have slots, which stay where they are.
class RecordedElimination::Search {
 public:
  Search(int size, std::size_t entries)
      : rows(index(size)), columns(index(size)), n_(size), place_(index(size) * index(size), -1) {
    value.reserve(4 * entries);
    for (int i = 0; i < size; ++i) left_.push_back(i);
  }

  int slot(int row, int column) const { return place_[index(row) * index(n_) + index(column)]; }
  int add(int row, int column, double v) {
    int& slot = place_[index(row) * index(n_) + index(column)];
    if (slot < 0) {
      slot = static_cast<int>(value.size());
      value.push_back(0.0);
      rows[index(row)].push_back(column);
      columns[index(column)].push_back(row);
    }
    value[index(slot)] += v;
    return slot;
  }

  struct Choice {
    int row = -1, column = -1;
  };
  // The entry that fills in least, the larger one of several.
  Choice choose() const {
    Choice best;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    double size = 0.0;
    for (int i : left_) {
      const std::vector<int>& row = rows[index(i)];
      double largest = 0.0;
      for (int j : row) largest = std::max(largest, std::fabs(value[index(slot(i, j))]));
      for (int j : row) {
        const std::size_t cost = (row.size() - 1) * (columns[index(j)].size() - 1);
        if (cost > least) continue;
        const double here = std::fabs(value[index(slot(i, j))]);
        if (!(here >= large_enough * largest && here > vanishing_pivot) || (cost == least && here <= size)) continue;
        best = {i, j};
        least = cost;
        size = here;
      }
    }
    return best;
  }
  // Both leave what is searched; the row without the pivot, and the column without it.
  std::pair<std::vector<int>, std::vector<int>> take(const Choice& pivot) {
    std::erase(left_, pivot.row);
    std::vector<int> row = std::move(rows[index(pivot.row)]), column = std::move(columns[index(pivot.column)]);
    std::erase(row, pivot.column);
    std::erase(column, pivot.row);
    for (int j : row) std::erase(columns[index(j)], pivot.row);
    for (int i : column) std::erase(rows[index(i)], pivot.column);
    return {std::move(row), std::move(column)};
  }

  std::vector<std::vector<int>> rows, columns;  // of what is left, the other index of its entries
  std::vector<double> value;                    // by slots

 private:
  int n_;
  std::vector<int> place_, left_;
};

bool RecordedElimination::choose(const SparsePattern& pattern, const double* values) {
  size_ = slots_ = 0;
  const int n = pattern.size;
  if (!all_finite_numbers(values, pattern.row.size())) return false;
  if (!equilibration_.compute(CompressedLines{n, n, pattern.first.data(), pattern.row.data()}, values)) return false;
  const auto power = [](int exponent) { return std::ldexp(1.0, exponent); };
  Search search(n, pattern.row.size());
  slot_of_entry_.clear();
  scale_.clear();
  for (int j = 0; j < n; ++j)
    for (int k = pattern.first[index(j)]; k < pattern.first[index(j) + 1]; ++k) {
      const int i = pattern.row[index(k)];
      scale_.push_back(power(equilibration_.of_lines()[index(j)] + equilibration_.of_crossings()[index(i)]));
      slot_of_entry_.push_back(search.add(i, j, scale_.back() * values[k]));
    }
  if (!eliminate(search)) return false;
  row_scale_.clear();
  column_scale_.clear();
  for (int k = 0; k < n; ++k) {
    row_scale_.push_back(power(equilibration_.of_crossings()[index(row_[index(k)])]));
    column_scale_.push_back(power(equilibration_.of_lines()[index(column_[index(k)])]));
  }
  size_ = n;
  slots_ = static_cast<int>(search.value.size());
  work_.assign(index(size_) + 1, 0.0);
  return true;
}

// A = L U with ones on the diagonal of U.
bool RecordedElimination::eliminate(Search& search) {
  const std::size_t n = search.rows.size();
  for (auto* list : {&row_, &column_, &pivot_}) list->clear();
  for (auto* list : {&lower_, &upper_}) list->clear();
  for (auto* first : {&first_lower_, &first_upper_, &first_update_}) first->assign(1, 0);
  updates_.clear();
  std::vector<int> place_of_row(n), place_of_column(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Search::Choice pivot = search.choose();
    if (pivot.row < 0) return false;
    const auto [row, column] = search.take(pivot);
    row_.push_back(pivot.row);
    column_.push_back(pivot.column);
    pivot_.push_back(search.slot(pivot.row, pivot.column));
    place_of_row[index(pivot.row)] = place_of_column[index(pivot.column)] = static_cast<int>(k);
    for (int i : column) lower_.push_back({search.slot(i, pivot.column), i});
    for (int j : row) {
      const int right = search.slot(pivot.row, j);
      upper_.push_back({right, j});
      const double factor = search.value[index(right)] /= search.value[index(pivot_.back())];
      for (int i : column) {
        const int left = search.slot(i, pivot.column);
        updates_.push_back({search.add(i, j, -factor * search.value[index(left)]), left, right});
      }
    }
    first_lower_.push_back(static_cast<int>(lower_.size()));
    first_upper_.push_back(static_cast<int>(upper_.size()));
    first_update_.push_back(static_cast<int>(updates_.size()));
  }
  for (Entry& entry : lower_) entry.place = place_of_row[index(entry.place)];
  for (Entry& entry : upper_) entry.place = place_of_column[index(entry.place)];
  return true;
}

// Pivots are replaced by their reciprocals.
bool RecordedElimination::factor(const double* values, double* factors) const {
  std::fill_n(factors, slots_, 0.0);
  for (std::size_t e = 0; e < slot_of_entry_.size(); ++e) factors[slot_of_entry_[e]] += scale_[e] * values[e];
  for (std::size_t k = 0; k < index(size_); ++k) {
    double& pivot = factors[pivot_[k]];
    double largest = 0.0;
    for (int u = first_upper_[k]; u < first_upper_[k + 1]; ++u)
      largest = std::max(largest, std::fabs(factors[upper_[index(u)].slot]));
    const double size = std::fabs(pivot);
    if (!(size > vanishing_pivot && size >= still_large_enough * largest && size <= largest_number)) return false;
    pivot = 1.0 / pivot;
    for (int u = first_upper_[k]; u < first_upper_[k + 1]; ++u) factors[upper_[index(u)].slot] *= pivot;
    for (int u = first_update_[k]; u < first_update_[k + 1]; ++u) {
      const Update& update = updates_[index(u)];
      factors[update.target] -= factors[update.left] * factors[update.right];
    }
  }
  return true;
}

void RecordedElimination::solve(const double* factors, double* b) {
  double* const y = work_.data();
  for (std::size_t k = 0; k < index(size_); ++k) y[k] = row_scale_[k] * b[row_[k]];
  for (std::size_t k = 0; k < index(size_); ++k) {
    y[k] *= factors[pivot_[k]];
    for (int l = first_lower_[k]; l < first_lower_[k + 1]; ++l)
      y[lower_[index(l)].place] -= factors[lower_[index(l)].slot] * y[k];
  }
  for (std::size_t k = index(size_); k-- > 0;) {
    double sum = y[k];
    for (int u = first_upper_[k]; u < first_upper_[k + 1]; ++u)
      sum -= factors[upper_[index(u)].slot] * y[upper_[index(u)].place];
    y[k] = sum;
  }
  for (std::size_t k = 0; k < index(size_); ++k) b[column_[k]] = column_scale_[k] * y[k];
}

}  // namespace sfdae::core
