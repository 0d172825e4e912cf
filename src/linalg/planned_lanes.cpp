// A listed elimination of several matrices side by side.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/planned_lanes.h"

#include "linalg/index.h"
#include "linalg/lane_algebra.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

using lane_algebra::set_abs;

struct PlannedLaneWork {
  const EliminationList& list;
  const Lanes *given, *b;
  int count;
  Lanes *scaled, *values, *inverse, *b_steps, *y, *r, *sums, *x;
  bool is_solved;
};

bool factor(const PlannedLaneWork& work) {
  const EliminationList& list = work.list;
  const Lanes* const given = work.given;
  Lanes *const values = work.values, *const scaled = work.scaled, *const inverses = work.inverse;
  const double* const entry_factor = list.entry_factor.data();
  const int *const position = list.position.data(), *const first_u = list.first_u.data(),
                   *const first_l = list.first_l.data(), *target = list.target.data();
  const std::size_t fill = list.fill, entries = list.position.size(), size = list.size();
  for (std::size_t e = 0; e < fill; ++e) values[e] = Lanes{};
  for (std::size_t e = 0; e < entries; ++e) {
    const Lanes value = entry_factor[e] * given[e];
    scaled[e] = value;
    values[position[e]] = value;
  }
  const Lanes* const U = values + size;
  Lanes* const L = values + size + first_u[size];
  for (std::size_t k = 0; k < size; ++k) {
    const Lanes pivot = values[k];
    if (any(pivot == 0.0)) return false;
    const Lanes inverse = 1.0 / pivot;
    inverses[k] = inverse;
    const int first = first_u[k], last = first_u[k + 1], last_l = first_l[k + 1];
    for (int l = first_l[k]; l < last_l; ++l) {
      const Lanes multiplier = L[l] * inverse;
      L[l] = multiplier;
      for (int u = first; u < last; ++u) values[*target++] -= multiplier * U[u];
    }
  }
  return true;
}

// width: of Columns, how many lie side by side.
template <class Columns>
void substitute(const PlannedLaneWork& work, Lanes* z, Columns width) {
  const EliminationList& list = work.list;
  const std::size_t size = list.size();
  const int *const first_l = list.first_l.data(), *const first_u = list.first_u.data(),
                   *const l_row = list.l_row.data(), *const u_column = list.u_column.data();
  const Lanes* const U = work.values + size;
  const Lanes *const L = U + first_u[size], *const inverses = work.inverse;
  for (std::size_t k = 0; k < size; ++k) {
    const Lanes* const known = z + k * index(width);
    const int last = first_l[k + 1];
    for (int l = first_l[k]; l < last; ++l) {
      Lanes* const to = z + l_row[l] * width;
      const Lanes factor = L[l];
      for (int c = 0; c < width; ++c) to[c] -= factor * known[c];
    }
  }
  for (std::size_t k = size; k-- > 0;) {
    Lanes* const sum = z + k * index(width);
    const int last = first_u[k + 1];
    for (int u = first_u[k]; u < last; ++u) {
      const Lanes* const from = z + u_column[u] * width;
      const Lanes factor = U[u];
      for (int c = 0; c < width; ++c) sum[c] -= factor * from[c];
    }
    const Lanes inverse = inverses[k];
    for (int c = 0; c < width; ++c) sum[c] *= inverse;
  }
}

// r := b - A y
template <class Columns>
void find_residual(const PlannedLaneWork& work, Columns width) {
  const EliminationList& list = work.list;
  const int length = static_cast<int>(list.size()) * width;
  const std::size_t entries = list.position.size();
  const int *const column_step = list.column_step.data(), *const row_step = list.row_step.data();
  const Lanes *const scaled = work.scaled, *const all_y = work.y, *const b = work.b_steps;
  Lanes* const all_r = work.r;
  for (int k = 0; k < length; ++k) all_r[k] = b[k];
  for (std::size_t e = 0; e < entries; ++e) {
    const Lanes a = scaled[e];
    const Lanes* const y = all_y + column_step[e] * width;
    Lanes* const r = all_r + row_step[e] * width;
    for (int c = 0; c < width; ++c) r[c] -= a * y[c];
  }
}

// True if the residual, relative to its terms, is below the limit of refusal.
template <class Columns>
bool is_residual_small(const PlannedLaneWork& work, Columns width) {
  const EliminationList& list = work.list;
  const int length = static_cast<int>(list.size()) * width;
  find_residual(work, width);
  for (int k = 0; k < length; ++k) set_abs(work.b_steps[k], work.sums[k]);
  for (std::size_t e = 0; e < list.position.size(); ++e)
    for (int c = 0; c < width; ++c) {
      Lanes size;
      set_abs(work.scaled[e] * work.y[list.column_step[e] * width + c], size);
      work.sums[list.row_step[e] * width + c] += size;
    }
  LaneMask bad{};
  for (int c = 0; c < width; ++c) {
    Lanes largest{}, sum{};
    for (int k = c; k < length; k += width) {
      note_not_finite(work.sums[k], bad);
      Lanes size;
      set_abs(work.r[k], size);
      largest = size > largest ? size : largest;
      sum = work.sums[k] > sum ? work.sums[k] : sum;
    }
    bad |= largest > refused_residuals * sum;
  }
  return !any(bad);
}

// y += change. False: a column changes by more than the limit for residuals, or is not finite.
template <class Columns>
bool refine(const PlannedLaneWork& work, const Lanes* change, Columns width) {
  const int length = static_cast<int>(work.list.size()) * width;
  LaneMask bad{};
  for (int c = 0; c < width; ++c) {
    Lanes largest{}, most{};
    for (int k = c; k < length; k += width) {
      work.y[k] += change[k];
      Lanes size;
      set_abs(change[k], size);
      largest = size > largest ? size : largest;
      set_abs(work.y[k], size);
      note_not_finite(size, bad);
      most = size > most ? size : most;
    }
    bad |= largest > refused_residuals * most;
  }
  return !any(bad);
}

template <class Columns>
bool solve_columns(const PlannedLaneWork& work, int first, Columns width) {
  const EliminationList& list = work.list;
  const int size = static_cast<int>(list.size());
  for (int i = 0; i < size; ++i)
    for (int c = 0; c < width; ++c) {
      const Lanes value = list.row_factor[index(i)] * work.b[(first + c) * size + i];
      work.b_steps[list.step_of_row[index(i)] * width + c] = value;
      work.y[list.step_of_row[index(i)] * width + c] = value;
    }
  substitute(work, work.y, width);
  find_residual(work, width);
  substitute(work, work.r, width);
  // Solutions that hardly change have a small residual, which is the criterion.
  if (!refine(work, work.r, width) && !is_residual_small(work, width)) return false;
  for (int j = 0; j < size; ++j)
    for (int c = 0; c < width; ++c)
      work.x[(first + c) * size + j] =
          list.column_factor[index(j)] * work.y[list.step_of_column[index(j)] * width + c];
  return true;
}

constexpr int at_once = 3;  // columns: their data stay in registers

template <int width>
struct Columns {
  constexpr operator int() const { return width; }
};

void eliminate(PlannedLaneWork& work) {
  work.is_solved = factor(work);
  int c = 0;
  for (; work.is_solved && c + at_once <= work.count; c += at_once)
    work.is_solved = solve_columns(work, c, Columns<at_once>());
  for (; work.is_solved && c < work.count; c += 1) work.is_solved = solve_columns(work, c, Columns<1>());
}
SFDAE_LANE_KERNEL(eliminate, PlannedLaneWork)

}  // namespace

bool PlannedLanes::solve(const EliminationList& list, const LaneBlock* values, const LaneBlock* b, int count,
                         LaneBlock* x) {
  const QuietArithmetic quiet;
  const std::size_t width = index(count < at_once ? count : at_once);
  scaled_.resize(list.position.size());
  values_.resize(list.fill);
  inverse_.resize(list.size());
  for (LaneArray* array : {&b_, &y_, &r_, &sums_}) array->resize(list.size() * width);
  PlannedLaneWork work{list,
                       to_lanes(values),
                       to_lanes(b),
                       count,
                       to_lanes(scaled_),
                       to_lanes(values_),
                       to_lanes(inverse_),
                       to_lanes(b_),
                       to_lanes(y_),
                       to_lanes(r_),
                       to_lanes(sums_),
                       to_lanes(x),
                       false};
  run_eliminate(work);
  return work.is_solved;
}

}  // namespace sfdae::core
