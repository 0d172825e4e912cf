// Sparsity of a matrix by compressed columns.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/column_pattern.h"

#include <algorithm>

#include "linalg/format.h"

namespace sfdae::core {

int ColumnPattern::column_of(int entry) const {
  return static_cast<int>(std::upper_bound(start.begin(), start.end(), entry) - start.begin()) - 1;
}

std::string complaint_about(const GivenPattern& given, const char* name, int rows, int columns) {
  if (given.start == nullptr || (given.row == nullptr && given.entries > 0))
    return format("the pattern of %s has %s, but no %s.", name, given.start != nullptr ? "col_start" : "row_index",
                  given.start != nullptr ? "row_index" : "col_start");
  if (given.entries < 0)
    return format("the pattern of %s has %d entries; it must be 0 or more.", name, given.entries);
  if (given.start[0] != 0) return format("the pattern of %s: col_start[0] is %d, not 0.", name, given.start[0]);
  for (int j = 0; j < columns; ++j)
    if (given.start[j + 1] < given.start[j] || given.start[j + 1] > given.entries)
      return format(
          "the pattern of %s: col_start[%d] is %d, col_start[%d] is %d; it must not decrease, and end at the %d "
          "entries.",
          name, j, given.start[j], j + 1, given.start[j + 1], given.entries);
  if (given.start[columns] != given.entries)
    return format("the pattern of %s: col_start[%d] is %d, but there are %d entries.", name, columns,
                  given.start[columns], given.entries);
  std::vector<int> seen(index(rows), -1);  // in which column
  for (int j = 0; j < columns; ++j)
    for (int e = given.start[j]; e < given.start[j + 1]; ++e) {
      const int i = given.row[e];
      if (i < 0 || i >= rows)
        return format("the pattern of %s: row_index[%d] is %d, in column %d; rows are 0 ... %d.", name, e, i, j,
                      rows - 1);
      if (seen[index(i)] == j)
        return format("the pattern of %s: row %d occurs twice in column %d, again at row_index[%d].", name, i, j, e);
      seen[index(i)] = j;
    }
  return "";
}

ColumnPattern column_pattern(const GivenPattern& given, int columns) {
  return {{given.start, given.start + columns + 1}, {given.row, given.row + given.entries}};
}

ColumnPattern united(const ColumnPattern& a, const ColumnPattern& b, int rows) {
  ColumnPattern result;
  std::vector<int> seen(index(rows), -1);
  for (int j = 0; j < a.columns(); ++j) {
    for (const ColumnPattern* pattern : {&a, &b})
      for (int e = pattern->start[index(j)]; e < pattern->start[index(j + 1)]; ++e) {
        const int i = pattern->row[index(e)];
        if (seen[index(i)] != j) result.row.push_back(i);
        seen[index(i)] = j;
      }
    result.start.push_back(result.entries());
  }
  return result;
}

void scatter(const ColumnPattern& pattern, const double* entries, int rows, double* matrix) {
  std::fill_n(matrix, index(rows) * index(pattern.columns()), 0.0);
  for (int j = 0; j < pattern.columns(); ++j)
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e)
      matrix[index(pattern.row[index(e)]) + index(rows) * index(j)] = entries[e];
}

void gather(const ColumnPattern& pattern, const double* matrix, int rows, double* entries) {
  for (int j = 0; j < pattern.columns(); ++j)
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e)
      entries[e] = matrix[index(pattern.row[index(e)]) + index(rows) * index(j)];
}

MatrixEntry entry_beyond(const ColumnPattern& pattern, int rows, const double* matrix) {
  std::vector<int> seen(index(rows), -1);
  for (int j = 0; j < pattern.columns(); ++j, matrix += rows) {
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e)
      seen[index(pattern.row[index(e)])] = j;
    for (int i = 0; i < rows; ++i)
      if (matrix[i] != 0.0 && seen[index(i)] != j) return {i, j};
  }
  return {};
}

ColumnGroups group_columns(const ColumnPattern& pattern, int rows) {
  std::vector<std::vector<int>> columns_of(index(rows));
  for (int j = 0; j < pattern.columns(); ++j)
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e)
      columns_of[index(pattern.row[index(e)])].push_back(j);
  std::vector<int> group_of(index(pattern.columns()), -1);
  std::vector<int> taken_by;  // of each group: the last column that cannot join it
  ColumnGroups groups;
  for (int j = 0; j < pattern.columns(); ++j) {
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e) {
      const std::vector<int>& others = columns_of[index(pattern.row[index(e)])];
      for (int other : others)
        if (group_of[index(other)] >= 0) taken_by[index(group_of[index(other)])] = j;
    }
    std::size_t group = 0;
    while (group < groups.size() && taken_by[group] == j) ++group;
    if (group == groups.size()) {
      groups.emplace_back();
      taken_by.push_back(-1);
    }
    groups[group].push_back(j);
    group_of[index(j)] = static_cast<int>(group);
  }
  return groups;
}

}  // namespace sfdae::core
