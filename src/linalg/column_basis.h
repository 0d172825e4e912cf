// Columns of a sparse matrix A with at least as many columns as rows that form a well-conditioned basis: one for each
// independent row, so that A_B, the square matrix of these rows and columns, is nonsingular.
//
// Elimination of the transpose, one row of A after the other, with threshold pivoting among the columns [GP88]: A = U^T
// L^T, L has a row for each column of A. The coefficients of a column in terms of the basis, A_B^-1 A_q, need L alone,
// as U cancels.
//
// [GP88] J. R. Gilbert, T. Peierls: Sparse partial pivoting in time proportional to arithmetic operations. SIAM J.
// Sci. Stat.
//        Comput. 9 (1988), 862-874.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace sfdae::core {

// In compressed rows: the entries of row i are first[i], ..., first[i + 1] - 1; each column at most once in a row.
// Finite.
struct SparseRows {
  int columns = 0;
  std::vector<int> first;  // rows + 1
  std::vector<int> column;
  std::vector<double> value;

  int rows() const { return first.empty() ? 0 : static_cast<int>(first.size()) - 1; }
};

struct BasisSettings {
  // Class of each column, 0 or more: lower classes are preferred in the basis. Empty: all are 0.
  std::vector<int> classes;
  // Rows and columns are scaled already.
  bool is_scaled = false;
  // All rows in the order in which they are eliminated. Empty: an order with little fill.
  std::vector<int> order;
  // In this order, a pivot of a lower class is taken above this part of the largest candidate; from 0 to 1.
  double threshold = 0.1;
  // A row whose candidates are this small, relative to the terms summed for them, depends on rows before it.
  double dependent = 1e-11;
  // An exchange needs a pivot above this part of the largest entry of A_B^-1 A_q (rows and columns scaled): smaller
  // ones count as zero. The condition of A_B can become worse by its reciprocal.
  double exchange = 1e-8;
};

struct ColumnBasis {
  // Pivot column of each row; -1: it depends on other rows. The columns form a basis as a set.
  std::vector<int> column_of_row;
  // Largest candidate of each row relative to the terms summed: below `dependent` if the row depends on others.
  std::vector<double> remaining;
  std::vector<int> left_over;  // columns that are not basic, ascending
  // The smallest of all pivots, relative to the terms summed for its row, and of those of exchanges, relative to the
  // largest entry of A_B^-1 A_q; 1 without any.
  double smallest_pivot = 1.0;
  int rank = 0;
  int exchanges = 0;
  // No column of class 0 is left over.
  bool has_all_of_class_0 = true;
  std::size_t fill = 0;  // entries of L
};

// Rows and columns are scaled by powers of two first, unless they are already. The basis has the largest possible
// number of columns of class 0, among those the largest of class 1, and so on: a column that is left over is exchanged
// for a basic one of a higher class if it depends on that one (the greedy algorithm of matroids makes this optimal),
// with a solution of L^T for each that is tried.
ColumnBasis column_basis(const SparseRows& a, const BasisSettings& settings = {});

}  // namespace sfdae::core
