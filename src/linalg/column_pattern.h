// Sparsity of a matrix by compressed columns, and groups of columns that have no row in common.
//
// [CPR74] A. R. Curtis, M. J. D. Powell, J. K. Reid: On the Estimation of Sparse Jacobian Matrices.
//         IMA J. Appl. Math. 13 (1974), 117-119.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

// Entries of column j: rows row[start[j]], ..., row[start[j + 1] - 1], in any order, none twice.
struct ColumnPattern {
  std::vector<int> start{0}, row;
  int columns() const { return static_cast<int>(start.size()) - 1; }
  int entries() const { return static_cast<int>(row.size()); }
  int column_of(int entry) const;
  bool operator==(const ColumnPattern&) const = default;
};

// A pattern as a user has supplied it: start has columns + 1 numbers, row as many as `entries` says.
struct GivenPattern {
  int entries = 0;
  const int *start = nullptr, *row = nullptr;
};
// Message about an invalid pattern, "" if it is valid. name: of the matrix.
std::string complaint_about(const GivenPattern& given, const char* name, int rows, int columns);
// Converts a valid pattern.
ColumnPattern column_pattern(const GivenPattern& given, int columns);

ColumnPattern united(const ColumnPattern& a, const ColumnPattern& b, int rows);

// Between entries in the order of the pattern and a dense matrix by columns.
void scatter(const ColumnPattern& pattern, const double* entries, int rows, double* matrix);
void gather(const ColumnPattern& pattern, const double* matrix, int rows, double* entries);

struct MatrixEntry {
  int row = -1, column = -1;
};
// The first entry of a dense matrix, by columns, that is nonzero and not in the pattern; row -1: none.
MatrixEntry entry_beyond(const ColumnPattern& pattern, int rows, const double* matrix);

// Columns of a group have no row in common: one finite difference gives all their entries [CPR74].
using ColumnGroups = std::vector<std::vector<int>>;
// Columns one after the other, each into the first group that it fits.
ColumnGroups group_columns(const ColumnPattern& pattern, int rows);

}  // namespace sfdae::core
