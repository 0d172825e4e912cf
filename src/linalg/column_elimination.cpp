// Left-looking: row by row of A, x := L^-1 A(i, :)^T, whose pattern is found first, by a search in depth [GP88].
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/column_elimination.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "linalg/band_order.h"
#include "linalg/index.h"

namespace sfdae::core {

ColumnElimination::ColumnElimination(const SparseRows& a, const BasisSettings& settings)
    : a_(a),
      settings_(settings),
      pivot_of_column_(index(a.columns), -1),
      first_of_pivot_(1, 0),
      x_(index(a.columns)),
      added_(index(a.columns)),
      seen_in_(index(a.columns), -1),
      count_(index(a.columns), 0) {
  for (int column : a.column) ++count_[index(column)];
  if (!settings.is_scaled) scales_.compute({a.rows(), a.columns, a.first.data(), a.column.data()}, a.value.data());
}

void ColumnElimination::run(ColumnBasis& result) {
  result.column_of_row.assign(index(a_.rows()), -1);
  result.remaining.assign(index(a_.rows()), 0.0);
  for (const int row : row_order()) {
    find_reach(row);
    eliminate();
    double largest = 0.0, added = 0.0;
    for (const int column : reached_) {
      added = std::max(added, added_[index(column)]);
      if (pivot_of_column_[index(column)] < 0) largest = std::max(largest, std::fabs(x_[index(column)]));
    }
    result.remaining[index(row)] = added > 0.0 ? largest / added : 0.0;
    if (largest == 0.0 || largest < settings_.dependent * added) continue;
    const int column = choose_pivot();
    result.column_of_row[index(row)] = column;
    result.smallest_pivot = std::min(result.smallest_pivot, std::fabs(x_[index(column)]) / added);
    add_pivot(row, column);
  }
  result.rank = static_cast<int>(row_of_pivot_.size());
  result.fill = entries_.size() + row_of_pivot_.size();
}

// Along a band if there is a narrow one (rows of a flow on 30 x 30 cells: 35 ms, 2200 by numbers of entries), else rows
// with few entries first (random rows: 50 ms, 156 along the band).
std::vector<int> ColumnElimination::row_order() const {
  if (!settings_.order.empty()) return settings_.order;
  std::vector<int> order(index(a_.rows()));
  std::iota(order.begin(), order.end(), 0);
  // A^T, with empty rows or columns so that it is square.
  SparsePattern pattern{std::max(a_.rows(), a_.columns), a_.first, a_.column};
  pattern.first.resize(index(pattern.size) + 1, a_.first.back());
  const BandOrder band = band_order(pattern, std::vector<int>(index(pattern.size), -1));
  constexpr int narrow = 8;
  const bool is_narrow = band.lower + band.upper <= pattern.size / narrow;
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) {
    if (is_narrow) return band.column_place[index(i)] < band.column_place[index(j)];
    return a_.first[index(i) + 1] - a_.first[index(i)] < a_.first[index(j) + 1] - a_.first[index(j)];
  });
  return order;
}

void ColumnElimination::find_reach(int row) {
  reached_.clear();
  for (int k = a_.first[index(row)]; k < a_.first[index(row) + 1]; ++k) {
    const int column = a_.column[index(k)];
    if (seen_in_[index(column)] != row) search(column, row);
  }
  for (const int column : reached_) x_[index(column)] = added_[index(column)] = 0.0;
  for (std::size_t k = index(a_.first[index(row)]); k < index(a_.first[index(row) + 1]); ++k) {
    const std::size_t column = index(a_.column[k]);
    x_[column] =
        settings_.is_scaled
            ? a_.value[k]
            : times_power_of_two(a_.value[k], scales_.of_lines()[index(row)] + scales_.of_crossings()[column]);
    added_[column] = std::fabs(x_[column]);
  }
}

// Columns after all columns that they change: postorder, without recursion.
void ColumnElimination::search(int column, int row) {
  stack_.assign(1, column);
  next_.assign(1, pivot_of_column_[index(column)] < 0 ? 0 : first_of_pivot_[index(pivot_of_column_[index(column)])]);
  seen_in_[index(column)] = row;
  while (!stack_.empty()) {
    const int pivot = pivot_of_column_[index(stack_.back())];
    const int end = pivot < 0 ? next_.back() : first_of_pivot_[index(pivot) + 1];
    if (next_.back() == end) {
      reached_.push_back(stack_.back());
      stack_.pop_back();
      next_.pop_back();
      continue;
    }
    const int child = entries_[index(next_.back()++)].place;
    if (seen_in_[index(child)] == row) continue;
    seen_in_[index(child)] = row;
    stack_.push_back(child);
    next_.push_back(pivot_of_column_[index(child)] < 0 ? 0 : first_of_pivot_[index(pivot_of_column_[index(child)])]);
  }
}

void ColumnElimination::eliminate() {
  for (auto column = reached_.rbegin(); column != reached_.rend(); ++column) {
    const int pivot = pivot_of_column_[index(*column)];
    const double u = x_[index(*column)];
    if (pivot < 0 || u == 0.0) continue;
    for (int k = first_of_pivot_[index(pivot)]; k < first_of_pivot_[index(pivot) + 1]; ++k) {
      const Entry& entry = entries_[index(k)];
      x_[index(entry.place)] -= u * entry.value;
      added_[index(entry.place)] += std::fabs(u * entry.value);
    }
  }
}

// The largest candidate of the lowest class that has one within the threshold.
int ColumnElimination::choose_pivot() const {
  double largest = 0.0;
  for (const int column : reached_)
    if (pivot_of_column_[index(column)] < 0) largest = std::max(largest, std::fabs(x_[index(column)]));
  const auto class_of = [&](int column) { return settings_.classes.empty() ? 0 : settings_.classes[index(column)]; };
  int best = -1;
  for (const int column : reached_) {
    const double size = std::fabs(x_[index(column)]);
    if (pivot_of_column_[index(column)] >= 0 || size == 0.0 || size < settings_.threshold * largest) continue;
    if (best < 0 || class_of(column) < class_of(best) ||
        (class_of(column) == class_of(best) &&
         (count_[index(column)] < count_[index(best)] ||
          (count_[index(column)] == count_[index(best)] && size > std::fabs(x_[index(best)])))))
      best = column;
  }
  return best;
}

void ColumnElimination::add_pivot(int row, int column) {
  const double pivot = x_[index(column)];
  for (const int other : reached_)
    if (other != column && pivot_of_column_[index(other)] < 0 && x_[index(other)] != 0.0)
      entries_.push_back({other, x_[index(other)] / pivot});
  pivot_of_column_[index(column)] = static_cast<int>(row_of_pivot_.size());
  row_of_pivot_.push_back(row);
  column_of_pivot_.push_back(column);
  first_of_pivot_.push_back(static_cast<int>(entries_.size()));
}

}  // namespace sfdae::core
