// Elimination of the rows of a sparse matrix A with pivots among its columns, for column_basis.h [GP88].
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/column_basis.h"
#include "linalg/equilibration.h"

namespace sfdae::core {

// Pivot k belongs to row row_of_pivot[k] and column column_of_pivot[k].
class ColumnElimination {
 public:
  ColumnElimination(const SparseRows& a, const BasisSettings& settings);
  // All rows; fills in the parts of the result known to the elimination.
  void run(ColumnBasis& result);

  struct Entry {
    int place;  // column of A in columns of L, pivot in its rows
    double value;
  };
  const std::vector<int>& row_of_pivot() const { return row_of_pivot_; }
  const std::vector<int>& column_of_pivot() const { return column_of_pivot_; }
  int pivot_of_column(int column) const { return pivot_of_column_[index(column)]; }  // -1: left over
  // Column k of L without its 1.
  const std::vector<Entry>& entries() const { return entries_; }
  const std::vector<int>& first_of_pivot() const { return first_of_pivot_; }

 private:
  std::vector<int> row_order() const;
  void find_reach(int row);
  void search(int column, int row);
  void eliminate();
  int choose_pivot() const;
  void add_pivot(int row, int column);

  const SparseRows& a_;
  const BasisSettings& settings_;
  Equilibration scales_;

  std::vector<int> row_of_pivot_, column_of_pivot_, pivot_of_column_;
  std::vector<int> first_of_pivot_;
  std::vector<Entry> entries_;

  // The row that is being eliminated: values of its columns, and the sizes of the terms summed for them.
  std::vector<double> x_, added_;
  std::vector<int> reached_;  // columns; those with pivots after all that they change
  std::vector<int> seen_in_;  // of columns: the row that met it last
  std::vector<int> stack_, next_;
  std::vector<int> count_;  // entries of columns of A
};

}  // namespace sfdae::core
