// Gaussian elimination of a matrix and of perturbed copies of it in lockstep: which numbers are values, and which are
// what errors of the data have left of zeros.
//
// Every entry that is not zero is uncertain by a small part of itself; zeros are exact. With v_0 an entry of the
// matrix on the way and v_k that of copy k, the significance
//
//     q = |v_0| / max_k |v_k - v_0|
//
// does not depend on units of rows and columns: q >> 1 is a value, which stays put relative to itself, q << 1 an
// error, which moves by more than its size (docs/decisions/32-certificates.md). Every elimination takes its pivots in
// all copies at the same places, the most significant entries first.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

#include "linalg/matrix.h"

namespace sfdae::core {

// Of the nonzero entries, relative: well above the rounding errors that the elimination itself makes.
inline constexpr double trial_perturbation = 1e-12;
// Pivots below this significance are unclear.
inline constexpr double clear_significance = 30.0;

// How far the decisions of one or several eliminations are from being others.
struct Significance {
  double weakest = std::numeric_limits<double>::infinity();  // smallest q of a pivot
  double strongest = 0.0;                                    // largest q of an entry that counts as zero
  double smallest_pivot = 1.0;  // relative to the largest entry of its matrix: what norms see
  // What relative errors of the data become in entries that count as zero, relative to the sizes that were added up in
  // their rows: values below that would not be seen.
  double amplification = 0.0;

  bool is_clear() const;
  // Not clear, but what is kept and dropped goes with what norms say.
  bool is_plausible() const;
  void join(const Significance& other);
};

// rows x cols entries, each of them with its copies.
class LockstepMatrix {
 public:
  static constexpr int copies = 5;
  static constexpr int lanes = copies + 1;  // the matrix itself is the first one

  LockstepMatrix() = default;
  LockstepMatrix(int rows, int cols);

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  double* at(int row, int col) { return values_.data() + first(row, col); }
  const double* at(int row, int col) const { return values_.data() + first(row, col); }

  // Rows by powers of two, so that the largest entry of each lies in [1, 2).
  void normalize_rows();

  // Eliminates the first `width` columns. The rows without pivots come to stand below those that have one; their
  // entries in these columns count as zero. Returns the rank. tolerance > 0: what is zero is decided by it alone, relative
  // to the largest entry of these columns.
  int eliminate(int width, Significance& significance, double tolerance = 0.0);

 private:
  struct Pivot {
    int row = -1, col = -1;
    double size = 0.0, significance = 0.0;
    double strongest = 0.0;  // q of the most significant entry that was seen
  };
  std::size_t first(int row, int col) const;
  Pivot find_pivot(int rank, const std::vector<char>& used) const;
  Pivot find_largest(int rank, const std::vector<char>& used, double threshold) const;
  void swap_rows(int i, int j);
  void subtract_pivot_row(int rank, int col, const std::vector<char>& used);
  void clear_rounding_errors(int row, int col);
  // An entry counts as zero.
  void drop(int row, int col, Significance& significance) const;
  // Rows from `top` on without any value become zero.
  void drop_rows(int top, int width, Significance& significance, double tolerance);

  int rows_ = 0, cols_ = 0;
  std::vector<double> values_;  // row after row, the copies of an entry beside each other
  std::vector<double> sums_;    // of the sizes of what was added up in each entry
};

}  // namespace sfdae::core
