// The loops of an elimination in lockstep.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/lockstep_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

namespace sfdae::core {

namespace {

constexpr int versions = LockstepMatrix::versions;
// Guards: an entry that does not move at all is clearly a value; one that moves from a size of zero hides all values.
constexpr double negligible = 1e-30, smallest_unit = 1e-300;

// Entries below this part of the sums, in all copies, are exact zeros with the rounding errors of the elimination,
// which are no perturbations of the data.
constexpr double arithmetic = 0x1p-47;
// Significances within this factor of each other are equivalent: the larger entry is the better pivot.
constexpr double alike = 4.0;

// Functions that return lanes are always inlined: how these are returned depends on the instruction set.
[[gnu::always_inline]] inline Lanes size_of(const Lanes& v) {
  return (Lanes)((LaneMask)v & std::numeric_limits<std::int64_t>::max());
}
[[gnu::always_inline]] inline Lanes larger(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
inline double largest(const Lanes& v) {
  double most = v[0];
  for (int l = 1; l < lane_count; ++l) most = v[l] > most ? v[l] : most;
  return most;
}

inline Lanes* entry(LockstepWork& w, int col, int group) {
  return &lanes(w.values[(col * w.groups + group) * versions]);
}
inline Lanes* column_of(LockstepWork& w, std::vector<LaneBlock>& of, int col) {
  return &lanes(of[index(col * w.groups)]);
}

inline double& number(std::vector<LaneBlock>& of, int groups, int row, int col) {
  return of[index(col * groups + row / lane_count)].lane[row % lane_count];
}
inline double* numbers(LockstepWork& w, int row, int col) {
  return w.values[(col * w.groups + row / lane_count) * versions].lane + row % lane_count;
}

// Products with 1 and 0 replace most choices between lanes, which GCC 12 makes piece by piece.
constexpr std::array<LaneBlock, lane_count + 1> make_places() {
  std::array<LaneBlock, lane_count + 1> places{};
  for (int first = 0; first <= lane_count; ++first)
    for (int l = first; l < lane_count; ++l) places[static_cast<std::size_t>(first)].lane[l] = 1.0;
  return places;
}
alignas(64) constexpr std::array<LaneBlock, lane_count + 1> places_from = make_places();

// 1 in the rows of a group from `row` on.
inline const Lanes& rows_from(int row, int group) {
  return lanes(places_from[index(std::clamp(row - group * lane_count, 0, lane_count))]);
}

// a / b for sizes, 1 / negligible at most: nothing is divided by zero.
[[gnu::always_inline]] inline Lanes ratio(const Lanes& a, const Lanes& b) {
  return a / larger(b, negligible * a + smallest_unit);
}

[[gnu::always_inline]] inline Lanes largest_move(const Lanes* v) {
  Lanes move{};
  for (int k = 1; k < versions; ++k) move = larger(size_of(v[k] - v[0]), move);
  return move;
}

[[gnu::always_inline]] inline Lanes significance_of(const Lanes* v) { return ratio(size_of(v[0]), largest_move(v)); }

// The pivot row of a column: all versions, and the sum of sizes.
struct PivotRow {
  double value[versions];
  double sum;
  bool is_zero;
};

inline PivotRow pivot_row_of(LockstepWork& w, int row, int col) {
  PivotRow p;
  const double* from = numbers(w, row, col);
  p.is_zero = true;
  for (int k = 0; k < versions; ++k) {
    p.value[k] = from[k * lane_count];
    p.is_zero = p.is_zero && p.value[k] == 0.0;
  }
  p.sum = number(w.sums, w.groups, row, col);
  return p;
}

// v -= factors p; rounding errors of that become zero. Rows without a factor stay as they are, bit by bit.
inline void subtract(const Lanes* factors, const PivotRow& p, Lanes* v, Lanes& sums) {
  Lanes most{};
  Lanes next[versions];
  for (int k = 0; k < versions; ++k) {
    next[k] = v[k] - factors[k] * p.value[k];
    most = larger(size_of(next[k]), most);
  }
  sums += size_of(factors[0]) * p.sum;
  const Lanes small = arithmetic * sums, none{};
  for (int k = 0; k < versions; ++k) v[k] = most <= small ? none : next[k];
}

// The pivot row of a step subtracted from all below it in one column.
struct Subtraction {
  int step, col;
  bool is_searched;  // for pivots of later steps
};

#if defined(__x86_64__) && defined(__GNUC__)

// subtract() and significance_of(), operation by operation, in two halves for AVX2: GCC 12 moves eight numbers piece by
// piece.
__attribute__((target("avx2"), noinline)) void subtract_in_halves(LockstepWork& w, const Subtraction& of,
                                                                  const PivotRow& p) {
  constexpr int half = lane_count / 2;
  const auto [step, col, is_searched] = of;
  const __m256d sign = _mm256_set1_pd(-0.0);
  const __m256d none = _mm256_setzero_pd();
  for (int g = step / lane_count; g < w.groups; ++g) {
    if (w.is_active[index(step * w.groups + g)] == 0) continue;
    const double* factors = w.factors[index((step * w.groups + g) * versions)].lane;
    double *v = w.values[(col * w.groups + g) * versions].lane, *sums = w.sums[index(col * w.groups + g)].lane;
    for (int l = 0; l < lane_count; l += half) {
      __m256d next[versions], most = none;
      for (int k = 0; k < versions; ++k) {
        const __m256d factor = _mm256_load_pd(factors + k * lane_count + l);
        const __m256d change = _mm256_mul_pd(factor, _mm256_set1_pd(p.value[k]));
        next[k] = _mm256_sub_pd(_mm256_load_pd(v + k * lane_count + l), change);
        most = _mm256_max_pd(_mm256_andnot_pd(sign, next[k]), most);
      }
      const __m256d added = _mm256_mul_pd(_mm256_andnot_pd(sign, _mm256_load_pd(factors + l)), _mm256_set1_pd(p.sum));
      const __m256d sum = _mm256_add_pd(_mm256_load_pd(sums + l), added);
      _mm256_store_pd(sums + l, sum);
      const __m256d is_small = _mm256_cmp_pd(most, _mm256_mul_pd(_mm256_set1_pd(arithmetic), sum), _CMP_LE_OQ);
      for (int k = 0; k < versions; ++k) {
        next[k] = _mm256_andnot_pd(is_small, next[k]);
        _mm256_store_pd(v + k * lane_count + l, next[k]);
      }
      if (!is_searched) continue;
      __m256d move = none;
      for (int k = 1; k < versions; ++k)
        move = _mm256_max_pd(_mm256_andnot_pd(sign, _mm256_sub_pd(next[k], next[0])), move);
      const __m256d size = _mm256_andnot_pd(sign, next[0]);
      const __m256d least =
          _mm256_add_pd(_mm256_mul_pd(_mm256_set1_pd(negligible), size), _mm256_set1_pd(smallest_unit));
      const __m256d significance = _mm256_div_pd(size, _mm256_max_pd(move, least));
      const double* counted = places_from[index(std::clamp(step + 1 - g * lane_count, 0, lane_count))].lane + l;
      _mm256_store_pd(w.significances[index(col * w.groups + g)].lane + l,
                      _mm256_mul_pd(_mm256_load_pd(counted), significance));
    }
  }
}

#else

inline void subtract_in_halves(LockstepWork&, const Subtraction&, const PivotRow&) {}

#endif

// Sums of sizes, significances and the largest entry at first.
inline double begin(LockstepWork& w) {
  Lanes most{};
  for (int j = 0; j < w.cols; ++j) {
    Lanes* sums = column_of(w, w.sums, j);
    for (int g = 0; g < w.groups; ++g) {
      const Lanes* v = entry(w, j, g);
      sums[g] = size_of(v[0]);
      if (j >= w.width) continue;
      most = larger(sums[g], most);
      column_of(w, w.significances, j)[g] = significance_of(v);
    }
  }
  return largest(most);
}

struct Pivot {
  int row = -1, col = -1;
  double size = 0.0, significance = 0.0;
};

// Row by row the most significant entry, of equivalent ones the largest; with a tolerance the largest one above
// `threshold`.
inline Pivot choose_pivot(LockstepWork& w, double threshold) {
  const bool by_size = w.tolerance > 0.0;
  Pivot best;
  best.size = by_size ? threshold : 0.0;
  for (int i = w.rank; i < w.rows; ++i)
    for (int j = 0; j < w.width; ++j) {
      const double q = number(w.significances, w.groups, i, j);
      if (w.used[index(j)] != 0 || (!by_size && q < std::max(1.0, best.significance / alike))) continue;
      const double size = std::fabs(*numbers(w, i, j));
      if (size > best.size || (!by_size && q > alike * best.significance)) best = {i, j, size, q};
    }
  return best;
}

inline void exchange_rows(LockstepWork& w, int i, int j, int col) {
  if (i == j) return;
  double *of_i = numbers(w, i, col), *of_j = numbers(w, j, col);
  for (int k = 0; k < versions; ++k) std::swap(of_i[k * lane_count], of_j[k * lane_count]);
  std::swap(number(w.sums, w.groups, i, col), number(w.sums, w.groups, j, col));
}

// Multipliers of the pivot in row `rank`; the column below it becomes zero. A copy without a pivot there (q = 1, which
// is never clear) is left alone.
inline void make_factors(LockstepWork& w, int col) {
  Lanes* factors = &lanes(w.factors[index(w.rank * w.groups * versions)]);
  const PivotRow pivot = pivot_row_of(w, w.rank, col);
  for (int g = w.rank / lane_count; g < w.groups; ++g) {
    Lanes* v = entry(w, col, g);
    const Lanes& behind = rows_from(w.rank + 1, g);
    Lanes most{};
    for (int k = 0; k < versions; ++k) {
      Lanes& factor = factors[g * versions + k];
      if (pivot.value[k] != 0.0) factor = behind * (v[k] / pivot.value[k]);
      v[k] -= behind * v[k];
      most = larger(size_of(factor), most);
    }
    w.is_active[index(w.rank * w.groups + g)] = largest(most) > 0.0;
  }
}

inline void subtract_pivot_row(LockstepWork& w, int step, int col, bool is_searched) {
  const PivotRow p = pivot_row_of(w, step, col);
  if (p.is_zero) return;
  if (w.in_halves) return subtract_in_halves(w, {step, col, is_searched}, p);
  const Lanes* factors = &lanes(w.factors[index(step * w.groups * versions)]);
  Lanes* sums = column_of(w, w.sums, col);
  for (int g = step / lane_count; g < w.groups; ++g) {
    if (w.is_active[index(step * w.groups + g)] == 0) continue;
    Lanes* v = entry(w, col, g);
    subtract(factors + g * versions, p, v, sums[g]);
    if (is_searched) column_of(w, w.significances, col)[g] = rows_from(step + 1, g) * significance_of(v);
  }
}

// One step in the columns that are eliminated; the others follow at the end, column by column.
inline void take_pivot(LockstepWork& w, const Pivot& pivot, double norm) {
  Significance& significance = w.significance;
  significance.weakest = std::min(significance.weakest, pivot.significance);
  significance.smallest_pivot = std::min(significance.smallest_pivot, pivot.size / norm);
  w.exchanged[index(w.rank)] = pivot.row;
  w.used[index(pivot.col)] = 1;
  for (int j = 0; j < w.width; ++j) {
    exchange_rows(w, w.rank, pivot.row, j);
    double& q = number(w.significances, w.groups, w.rank, j);
    number(w.significances, w.groups, pivot.row, j) = q;
    q = 0.0;
  }
  make_factors(w, pivot.col);
  for (int j = 0; j < w.width; ++j)
    if (w.used[index(j)] == 0) subtract_pivot_row(w, w.rank, j, true);
  ++w.rank;
}

inline void measure_sums(LockstepWork& w, int first, int end) {
  for (int g = w.rank / lane_count; g < w.groups; ++g) {
    Lanes& most = lanes(w.largest_sums[index(g)]);
    for (int j = first; j < end; ++j) most = larger(column_of(w, w.sums, j)[g], most);
  }
}

// The largest q and amplification of entries that count as zero, row by row.
struct Zeros {
  Lanes strongest{}, amplification{};
};

// Entries that count as zero, in rows weighted by 1, not in those weighted by 0.
inline void drop(LockstepWork& w, int col, int group, const Lanes& counted, Zeros& zeros) {
  const Lanes* v = entry(w, col, group);
  const Lanes seen = trial_perturbation * lanes(w.largest_sums[index(group)]);
  zeros.strongest = larger(counted * significance_of(v), zeros.strongest);
  zeros.amplification = larger(counted * ratio(largest_move(v), seen), zeros.amplification);
}

inline void note(const Zeros& zeros, Significance& significance) {
  significance.strongest = std::max(significance.strongest, largest(zeros.strongest));
  significance.amplification = std::max(significance.amplification, largest(zeros.amplification));
}

// All steps in one of the columns that are not eliminated.
inline void follow(LockstepWork& w, int col) {
  for (int step = 0; step < w.rank; ++step) {
    exchange_rows(w, step, w.exchanged[index(step)], col);
    subtract_pivot_row(w, step, col, false);
  }
}

// Remaining entries in the columns that were eliminated.
inline void drop_columns(LockstepWork& w, Zeros& zeros) {
  measure_sums(w, 0, w.scale == ZeroScale::whole_rows ? w.cols : w.width);
  for (int j = 0; j < w.width; ++j)
    for (int g = w.rank / lane_count; g < w.groups && w.used[index(j)] == 0; ++g)
      drop(w, j, g, rows_from(w.rank, g), zeros);
}

// 1 for the rows of a group that have no values in the columns that are not eliminated: by q, or by the tolerance.
inline bool find_rows_without_values(LockstepWork& w, int group, LaneBlock& found) {
  LaneBlock most;
  for (int j = w.width; j < w.cols; ++j) {
    const Lanes* v = entry(w, j, group);
    lanes(most) = larger(w.tolerance > 0.0 ? size_of(v[0]) : significance_of(v), lanes(most));
  }
  found = places_from[index(std::clamp(w.rank - group * lane_count, 0, lane_count))];
  bool is_any = false;
  for (int l = 0; l < lane_count; ++l) {
    const bool has_values =
        w.tolerance > 0.0 ? most.lane[l] > w.tolerance * w.largest_sums[index(group)].lane[l] : most.lane[l] >= 1.0;
    if (has_values) found.lane[l] = 0.0;
    is_any = is_any || found.lane[l] > 0.0;
  }
  return is_any;
}

// Rows without pivots and without any value become zero.
inline void drop_rows(LockstepWork& w, Zeros& zeros) {
  measure_sums(w, 0, w.cols);
  for (int g = w.rank / lane_count; g < w.groups; ++g) {
    LaneBlock dropped;
    if (!find_rows_without_values(w, g, dropped)) continue;
    for (int j = w.width; j < w.cols; ++j) {
      drop(w, j, g, lanes(dropped), zeros);
      Lanes* v = entry(w, j, g);
      for (int k = 0; k < versions; ++k) v[k] -= lanes(dropped) * v[k];
    }
  }
}

// Overflow makes the result unclear.
inline void doubt_overflow(LockstepWork& w) {
  LaneMask found{};
  for (const LaneBlock& sums : w.sums) note_not_finite(lanes(sums), found);
  if (any(found)) w.significance.weakest = 0.0;
}

inline void eliminate(LockstepWork& w) {
  const double norm = begin(w);
  for (w.rank = 0; w.rank < std::min(w.rows, w.width);) {
    const Pivot pivot = choose_pivot(w, w.tolerance * norm);
    if (pivot.row < 0) break;
    take_pivot(w, pivot, norm);
  }
  for (int j = w.width; j < w.cols; ++j) follow(w, j);
  Zeros zeros;
  drop_columns(w, zeros);
  drop_rows(w, zeros);
  note(zeros, w.significance);
  doubt_overflow(w);
}

SFDAE_LANE_KERNEL(eliminate, LockstepWork)

}  // namespace

void eliminate_in_lockstep(LockstepWork& work) {
  work.in_halves = instruction_set_of_lanes() == InstructionSet::avx2;
  run_eliminate(work);
}

}  // namespace sfdae::core
