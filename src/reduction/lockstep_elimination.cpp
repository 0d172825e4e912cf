// Elimination of a matrix and of perturbed copies in lockstep.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/lockstep_elimination.h"

#include <algorithm>
#include <cmath>

#include "reduction/lockstep_kernel.h"

namespace sfdae::core {

namespace {

// Bounds of amplifications and significances that make decisions clear: docs/design/rank_decisions.md.
constexpr double moderate_amplification = 1e4, largest_amplification = 1e8;
constexpr double visible_value = 3.0, certain_value = 1e6;
// Bound for zeros amplified by errors: above, they are clear of single roundings of the data.
constexpr double rounding_significance = 2e-3;

}  // namespace

bool Significance::is_plausible() const { return amplification < moderate_amplification; }

bool Significance::is_clear() const {
  // Rounding errors that grow to 1e-12 allow a simple test: an entry is zero if it moves by more than its own size, and
  // values may move by a third. If they grow to 1e-8, zeros have to move by far more than their size, and no value is
  // hidden only if all the others are certain.
  if (amplification < moderate_amplification) return weakest > visible_value && strongest < 1.0;
  return amplification < largest_amplification && weakest > certain_value && strongest < rounding_significance;
}

void Significance::join(const Significance& other) {
  weakest = std::min(weakest, other.weakest);
  strongest = std::max(strongest, other.strongest);
  smallest_pivot = std::min(smallest_pivot, other.smallest_pivot);
  amplification = std::max(amplification, other.amplification);
}

LockstepMatrix::LockstepMatrix(int rows, int cols)
    : rows_(rows),
      cols_(cols),
      groups_((rows + lane_count - 1) / lane_count),
      values_(index(cols) * index(groups_) * index(versions)) {}

void LockstepMatrix::normalize_rows() {
  std::vector<double> factors(index(groups_ * lane_count), 0.0);
  for (int j = 0; j < cols_; ++j)
    for (int i = 0; i < rows_; ++i) factors[index(i)] = std::max(factors[index(i)], std::fabs(at(i, j)));
  for (double& factor : factors)
    factor = factor > 0.0 && std::isfinite(factor) ? std::ldexp(1.0, -std::ilogb(factor)) : 1.0;
  for (int j = 0; j < cols_; ++j) {
    LaneBlock* blocks = column(j);
    for (int b = 0; b < blocks_of_column(); ++b)
      for (int l = 0; l < lane_count; ++l) blocks[b].lane[l] *= factors[index(b / versions * lane_count + l)];
  }
}

int LockstepMatrix::eliminate(int width, Significance& significance, double tolerance, ZeroScale scale) {
  LockstepWork work;
  work.values = values_.data();
  work.rows = rows_;
  work.cols = cols_;
  work.width = width;
  work.groups = groups_;
  work.tolerance = tolerance;
  work.scale = scale;
  const std::size_t groups = index(groups_), steps = index(std::min(rows_, width));
  // One more of each: columns without rows have an address, too.
  work.sums.resize(index(cols_) * groups + 1);
  work.significances.resize(index(width) * groups + 1);
  work.factors.resize(steps * groups * index(versions) + 1);
  work.is_active.resize(steps * groups);
  work.exchanged.resize(steps);
  work.used.resize(index(width));
  work.largest_sums.resize(groups + 1);
  eliminate_in_lockstep(work);
  significance.join(work.significance);
  return work.rank;
}

}  // namespace sfdae::core
