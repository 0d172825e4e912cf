// Gaussian elimination of a matrix and of perturbed copies of it in lockstep, which distinguishes values from zeros
// with errors of the data.
//
// Every entry that is not zero is uncertain by a small part of itself; zeros are exact. With v_0 an entry of the matrix
// during elimination and v_k that of copy k, the significance
//
//     q = |v_0| / max_k |v_k - v_0|
//
// does not depend on units of rows and columns: q >> 1 is a value, which stays put relative to itself, q << 1 an
// error, which moves by more than its size (docs/design/rank_decisions.md). Every elimination takes its pivots in
// all copies at the same places, the most significant entries first.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "linalg/index.h"
#include "linalg/lanes.h"

namespace sfdae::core {

// Relative perturbations of the nonzero entries: well above the rounding errors of the elimination itself.
inline constexpr double trial_perturbation = 1e-12;
// Pivots below this significance are unclear.
inline constexpr double clear_significance = 30.0;

// Distance of the decisions of one or several eliminations from being others.
struct Significance {
  double weakest = std::numeric_limits<double>::infinity();  // smallest q of a pivot
  double strongest = 0.0;                                    // largest q of an entry that counts as zero
  double smallest_pivot = 1.0;  // relative to the largest entry of its matrix, the measure of norms
  // Growth of relative errors of the data in entries that count as zero, relative to the sums of sizes in their rows:
  // smaller values would not be visible.
  double amplification = 0.0;

  bool is_clear() const;
  // Not clear, but kept and dropped values agree with norms.
  bool is_plausible() const;
  void join(const Significance& other);
};

// Scale of the zeros of an elimination: the sums of sizes in all of their row, or in the eliminated columns only.
enum class ZeroScale { whole_rows, eliminated_columns };

// rows x cols entries, each of them with its copies.
class LockstepMatrix {
 public:
  static constexpr int copies = 5;
  static constexpr int versions = copies + 1;  // the matrix itself is the first one

  LockstepMatrix() = default;
  LockstepMatrix(int rows, int cols);

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  double& at(int row, int col, int version = 0) { return values_[block(row, col, version)].lane[row % lane_count]; }
  double at(int row, int col, int version = 0) const {
    return values_[block(row, col, version)].lane[row % lane_count];
  }
  // Eight rows of the matrix, the same ones of each copy, and then the next eight; zeros behind the last row.
  int blocks_of_column() const { return groups_ * versions; }
  LaneBlock* column(int col) { return values_.data() + block(0, col, 0); }
  const LaneBlock* column(int col) const { return values_.data() + block(0, col, 0); }

  // Rows by powers of two, so that the largest entry of each lies in [1, 2).
  void normalize_rows();

  // Eliminates the first `width` columns. The rows without pivots are placed below those that have one; their entries
  // in these columns count as zero. Returns the rank. tolerance > 0: it alone decides which entries are zero, relative
  // to the largest entry of these columns.
  int eliminate(int width, Significance& significance, double tolerance = 0.0,
                ZeroScale scale = ZeroScale::whole_rows);

 private:
  std::size_t block(int row, int col, int version) const {
    return (index(col) * index(groups_) + index(row / lane_count)) * index(versions) + index(version);
  }

  int rows_ = 0, cols_ = 0;
  int groups_ = 0;  // of eight rows
  LaneArray values_;
};

}  // namespace sfdae::core
