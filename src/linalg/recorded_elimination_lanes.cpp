// A recorded elimination repeated for the matrices of eight points side by side.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "linalg/index.h"
#include "linalg/lanes.h"
#include "linalg/recorded_elimination.h"

namespace sfdae::core {

namespace {

using List = RecordedElimination::List;

// Pivots for all points: one that is good for each may not exist. Solutions are refined with residuals of the original
// equations, so that rounding errors may grow.
constexpr double least_part_of_row = 1e-4;

struct FactorWork {
  const List& list;
  const RecordedElimination::PivotBounds& bounds;
  const Lanes* values;
  Lanes* factors;
  LaneMask refused;
};

// RecordedElimination::factor, up to the first pivot that is refused in any lane.
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

// The first lanes alone, two at a time: vectors of any processor have at least two numbers.
typedef double TwoLanes __attribute__((vector_size(16), may_alias));
template <int pairs>
struct __attribute__((may_alias)) SomeLanes {
  TwoLanes part[pairs];
  SomeLanes& operator-=(const SomeLanes& other) {
    for (int p = 0; p < pairs; ++p) part[p] -= other.part[p];
    return *this;
  }
  friend SomeLanes operator*(const SomeLanes& one, const SomeLanes& other) {
    SomeLanes product;
    for (int p = 0; p < pairs; ++p) product.part[p] = one.part[p] * other.part[p];
    return product;
  }
  friend SomeLanes operator*(double one, const SomeLanes& other) {
    SomeLanes product;
    for (int p = 0; p < pairs; ++p) product.part[p] = one * other.part[p];
    return product;
  }
};

// The first lanes of each block of lanes.
template <class Some, class Block = LaneBlock>
struct First {
  Block* blocks;
  template <class Place>
  Some& operator[](Place k) const {
    return *reinterpret_cast<Some*>(blocks + k);
  }
};
template <class Some>
using FirstOfConst = First<const Some, const LaneBlock>;

struct SolveWork {
  const List& list;
  const LaneBlock* factors;
  LaneBlock *b, *y;
};

// RecordedElimination::solve for lanes.
template <class Some>
void solve_some(SolveWork& work) {
  const List& list = work.list;
  const FirstOfConst<Some> factors{work.factors};
  const First<Some> y{work.y}, b{work.b};
  const std::size_t size = index(list.size);
  for (std::size_t k = 0; k < size; ++k) y[k] = list.row_scale[k] * b[list.row[k]];
  for (std::size_t k = 0; k < size; ++k) {
    const Some solved = y[k] * factors[list.pivot[k]];
    y[k] = solved;
    for (int l = list.first_lower[k]; l < list.first_lower[k + 1]; ++l)
      y[list.lower[index(l)].place] -= factors[list.lower[index(l)].slot] * solved;
  }
  for (std::size_t k = size; k-- > 0;) {
    Some sum = y[k];
    for (int u = list.first_upper[k]; u < list.first_upper[k + 1]; ++u)
      sum -= factors[list.upper[index(u)].slot] * y[list.upper[index(u)].place];
    y[k] = sum;
  }
  for (std::size_t k = 0; k < size; ++k) b[list.column[k]] = list.column_scale[k] * y[k];
}
void solve_all(SolveWork& work) { solve_some<Lanes>(work); }

struct RowWork {
  const List& list;
  const LaneBlock* factors;
  std::size_t first;  // place of the row
  LaneBlock unit;     // its scale
  LaneBlock *x, *y;
};

// RecordedElimination::substitute_transposed, with a unit vector.
template <class Some>
void find_row(RowWork& work) {
  const List& list = work.list;
  const FirstOfConst<Some> factors{work.factors};
  const First<Some> y{work.y}, x{work.x};
  const std::size_t size = index(list.size);
  const Some unit = *reinterpret_cast<const Some*>(&work.unit), zero = 0.0 * unit;
  for (std::size_t k = 0; k < size; ++k) y[k] = zero;
  y[work.first] = unit;
  for (std::size_t k = work.first; k < size; ++k) {
    const Some solved = y[k];
    for (int u = list.first_upper[k]; u < list.first_upper[k + 1]; ++u)
      y[list.upper[index(u)].place] -= factors[list.upper[index(u)].slot] * solved;
  }
  for (std::size_t k = size; k-- > 0;) {
    Some sum = y[k];
    for (int l = list.first_lower[k]; l < list.first_lower[k + 1]; ++l)
      sum -= factors[list.lower[index(l)].slot] * y[list.lower[index(l)].place];
    sum = sum * factors[list.pivot[k]];
    y[k] = sum;
    x[list.row[k]] = list.row_scale[k] * sum;
  }
}
void find_row_of_all(RowWork& work) { find_row<Lanes>(work); }

SFDAE_LANE_KERNEL(factor_all, FactorWork)
SFDAE_LANE_KERNEL(solve_all, SolveWork)
SFDAE_LANE_KERNEL(find_row_of_all, RowWork)

// A block of lanes is more than one vector.
bool has_short_vectors() { return instruction_set_of_lanes() != InstructionSet::avx512; }

}  // namespace

int RecordedElimination::factor_lanes(const LaneBlock* values, LaneBlock* factors) const {
  FactorWork work{list_, pivot_bounds, &lanes(*values), &lanes(*factors), {}};
  run_factor_all(work);
  for (int l = 0; l < lane_count; ++l)
    if (work.refused[l] != 0) return l;
  return -1;
}

void RecordedElimination::solve_lanes(const LaneBlock* factors, int count, LaneBlock* b) {
  lanes_.resize(std::max(lanes_.size(), index(list_.size)));
  SolveWork work{list_, factors, b, lanes_.data()};
  if (has_short_vectors() && count <= 4) solve_some<SomeLanes<2>>(work);
  else if (has_short_vectors() && count <= 6) solve_some<SomeLanes<3>>(work);
  else run_solve_all(work);
}

void RecordedElimination::row_of_inverse_lanes(const LaneBlock* factors, int count, int row, LaneBlock* x) {
  lanes_.resize(std::max(lanes_.size(), index(list_.size)));
  const auto place = std::find(list_.column.begin(), list_.column.end(), row) - list_.column.begin();
  RowWork work{list_, factors, static_cast<std::size_t>(place), {}, x, lanes_.data()};
  std::fill_n(work.unit.lane, lane_count, list_.column_scale[work.first]);
  if (has_short_vectors() && count <= 4) find_row<SomeLanes<2>>(work);
  else if (has_short_vectors() && count <= 6) find_row<SomeLanes<3>>(work);
  else run_find_row_of_all(work);
}

}  // namespace sfdae::core
