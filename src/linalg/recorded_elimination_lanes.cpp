// A recorded elimination repeated for the matrices of eight points side by side.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "linalg/index.h"
#include "linalg/lanes.h"
#include "linalg/recorded_elimination.h"

namespace sfdae::core {

namespace {

using List = RecordedElimination::List;

// Pivots of all points: one that is good for each may not exist. What is solved is iterated, with residuals of the equations
// themselves, so that rounding errors may grow.
constexpr double least_part_of_row = 1e-4;

struct FactorWork {
  const List& list;
  const RecordedElimination::PivotBounds& bounds;
  const Lanes* values;
  Lanes* factors;
  LaneMask refused;
};

// As RecordedElimination::factor, up to the first pivot that is refused in any lane.
void factor_all(FactorWork& work) {
  const List& list = work.list;
  Lanes* const factors = work.factors;
  for (int slot = 0; slot < list.slots; ++slot) factors[slot] = Lanes{};
  for (std::size_t e = 0; e < list.slot_of_entry.size(); ++e)
    factors[list.slot_of_entry[e]] += list.scale[e] * work.values[e];
  for (std::size_t k = 0; k < index(list.size); ++k) {
    Lanes& pivot = factors[list.pivot[k]];
    Lanes largest{};
    for (int u = list.first_upper[k]; u < list.first_upper[k + 1]; ++u) {
      const Lanes entry = factors[list.upper[index(u)].slot], size = entry < 0.0 ? -entry : entry;
      largest = size > largest ? size : largest;
    }
    const Lanes size = pivot < 0.0 ? -pivot : pivot;
    const LaneMask serves =
        (size > work.bounds.least) & (size >= least_part_of_row * largest) & (size <= work.bounds.largest);
    work.refused = ~serves;
    if (any(work.refused)) return;
    pivot = 1.0 / pivot;
    for (int u = list.first_upper[k]; u < list.first_upper[k + 1]; ++u) factors[list.upper[index(u)].slot] *= pivot;
    for (int u = list.first_update[k]; u < list.first_update[k + 1]; ++u) {
      const RecordedElimination::Update& update = list.updates[index(u)];
      factors[update.target] -= factors[update.left] * factors[update.right];
    }
  }
}

struct SolveWork {
  const List& list;
  const Lanes* factors;
  Lanes *b, *y;
};

// As RecordedElimination::solve.
void solve_all(SolveWork& work) {
  const List& list = work.list;
  const Lanes* const factors = work.factors;
  Lanes* const y = work.y;
  const std::size_t size = index(list.size);
  for (std::size_t k = 0; k < size; ++k) y[k] = list.row_scale[k] * work.b[list.row[k]];
  for (std::size_t k = 0; k < size; ++k) {
    const Lanes solved = y[k] * factors[list.pivot[k]];
    y[k] = solved;
    for (int l = list.first_lower[k]; l < list.first_lower[k + 1]; ++l)
      y[list.lower[index(l)].place] -= factors[list.lower[index(l)].slot] * solved;
  }
  for (std::size_t k = size; k-- > 0;) {
    Lanes sum = y[k];
    for (int u = list.first_upper[k]; u < list.first_upper[k + 1]; ++u)
      sum -= factors[list.upper[index(u)].slot] * y[list.upper[index(u)].place];
    y[k] = sum;
  }
  for (std::size_t k = 0; k < size; ++k) work.b[list.column[k]] = list.column_scale[k] * y[k];
}

SFDAE_LANE_KERNEL(factor_all, FactorWork)
SFDAE_LANE_KERNEL(solve_all, SolveWork)

}  // namespace

int RecordedElimination::factor_lanes(const LaneBlock* values, LaneBlock* factors) const {
  FactorWork work{list_, pivot_bounds, &lanes(*values), &lanes(*factors), {}};
  run_factor_all(work);
  for (int l = 0; l < lane_count; ++l)
    if (work.refused[l] != 0) return l;
  return -1;
}

void RecordedElimination::solve_lanes(const LaneBlock* factors, LaneBlock* b) {
  lanes_.resize(std::max(lanes_.size(), index(list_.size)));
  SolveWork work{list_, &lanes(*factors), &lanes(*b), &lanes(*lanes_.data())};
  run_solve_all(work);
}

}  // namespace sfdae::core
