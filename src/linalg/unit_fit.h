// Exponents of units that bring the entries of E x' = A x near one, by weighted least squares of their logarithms. A
// single matrix takes the place of A.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "linalg/matrix.h"

namespace sfdae::core {

// Deviations to be minimized: bits + r_i + c_j - time s for each entry that counts. Dense: passes over whole columns
// cost less than lists of entries, even with many zeros.
struct EntrySizes {
  struct Block {
    double time;    // 1 for E, 0 for A
    Matrix bits;    // log2 |a_ij|, 0 where there is no entry
    Matrix counts;  // 1, or 0: no entry, or one that is left out
  };
  EntrySizes(int rows, int columns);
  int m, n;
  std::array<Block, 2> blocks;  // E, A
  std::size_t count() const;    // of entries that count
};

// Exponents of all units: r, c and s.
struct UnitExponents {
  UnitExponents(int m, int n);
  std::vector<double> rows, unknowns;
  double time = 0.0;
  // r_i + c_j - time s
  double sum_at(const EntrySizes::Block& block, int i, int j) const {
    return rows[index(i)] + unknowns[index(j)] - block.time * time;
  }
};

// Least squares, starting at x: directions without effect stay as they are.
void fit_squares(const EntrySizes& sizes, UnitExponents& x);
// Least absolute values, which are insensitive to outliers, approximated by reweighted least squares.
void fit_absolute_values(const EntrySizes& sizes, UnitExponents& x);

}  // namespace sfdae::core
