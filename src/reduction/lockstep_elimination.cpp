// Elimination of a matrix and of perturbed copies in lockstep.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/lockstep_elimination.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Entries below this part of what was added up, in all copies, are exact zeros with the rounding errors of the
// elimination, which are no perturbations of the data.
constexpr double arithmetic = 0x1p-47;
// Bounds of amplifications and significances that make decisions clear: docs/decisions/32-certificates.md.
constexpr double moderate_amplification = 1e4, largest_amplification = 1e8;
constexpr double visible_value = 3.0, certain_value = 1e6;
// Of zeros that errors have blown up: above, they stand clear of single roundings of the data.
constexpr double rounding_significance = 2e-3;
// Significances within this factor of each other are alike: the larger entry is the better pivot.
constexpr double alike = 4.0;

double largest_move(const double* entry) {
  double move = 0.0;
  for (int k = 1; k < LockstepMatrix::lanes; ++k) move = std::max(move, std::fabs(entry[k] - entry[0]));
  return move;
}

double significance_of(const double* entry) {
  const double move = largest_move(entry);
  return move > 0.0 ? std::fabs(entry[0]) / move : std::numeric_limits<double>::infinity();
}

bool is_zero(const double* entry) {
  return std::all_of(entry, entry + LockstepMatrix::lanes, [](double v) { return v == 0.0; });
}

}  // namespace

bool Significance::is_plausible() const { return amplification < moderate_amplification; }

bool Significance::is_clear() const {
  // Errors of rounding that grow to 1e-12 leave room for what counts as zero to be one: everything that moves by more
  // than its own size is, and values may move by a third. Where they grow to 1e-8, zeros have to move by far more than
  // their size, and values that could be hidden are looked for in vain only if all the others are certain.
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
    : rows_(rows), cols_(cols), values_(index(rows) * index(cols) * index(lanes), 0.0) {}

std::size_t LockstepMatrix::first(int row, int col) const {
  return (index(row) * index(cols_) + index(col)) * index(lanes);
}

void LockstepMatrix::normalize_rows() {
  for (int i = 0; i < rows_; ++i) {
    double largest = 0.0;
    for (int j = 0; j < cols_; ++j) largest = std::max(largest, std::fabs(at(i, j)[0]));
    if (!(largest > 0.0) || !std::isfinite(largest)) continue;
    const double factor = std::ldexp(1.0, -std::ilogb(largest));
    double* row = at(i, 0);
    for (std::size_t k = 0; k < index(cols_) * index(lanes); ++k) row[k] *= factor;
  }
}

// The most significant entry, of those alike the largest one.
LockstepMatrix::Pivot LockstepMatrix::find_pivot(int rank, const std::vector<char>& used) const {
  Pivot best;
  for (int i = rank; i < rows_; ++i)
    for (std::size_t j = 0; j < used.size(); ++j) {
      const double* entry = at(i, static_cast<int>(j));
      const double size = std::fabs(entry[0]);
      if (used[j] != 0 || size == 0.0) continue;
      const double q = significance_of(entry);
      best.strongest = std::max(best.strongest, q);
      if (q < 1.0) continue;
      if (q > alike * best.significance || (q >= best.significance / alike && size > best.size))
        best = {i, static_cast<int>(j), size, q, best.strongest};
    }
  return best;
}

LockstepMatrix::Pivot LockstepMatrix::find_largest(int rank, const std::vector<char>& used, double threshold) const {
  Pivot best;
  best.size = threshold;
  for (int i = rank; i < rows_; ++i)
    for (std::size_t j = 0; j < used.size(); ++j) {
      const double* entry = at(i, static_cast<int>(j));
      if (used[j] != 0 || !(std::fabs(entry[0]) > best.size)) continue;
      best = {i, static_cast<int>(j), std::fabs(entry[0]), significance_of(entry)};
    }
  return best;
}

void LockstepMatrix::swap_rows(int i, int j) {
  if (i == j) return;
  std::swap_ranges(at(i, 0), at(i, 0) + cols_ * lanes, at(j, 0));
  double* sums = sums_.data();
  std::swap_ranges(sums + i * cols_, sums + (i + 1) * cols_, sums + j * cols_);
}

void LockstepMatrix::clear_rounding_errors(int row, int col) {
  double* entry = at(row, col);
  const double small = arithmetic * sums_[index(row) * index(cols_) + index(col)];
  if (std::all_of(entry, entry + lanes, [small](double v) { return std::fabs(v) <= small; }))
    std::fill_n(entry, lanes, 0.0);
}

void LockstepMatrix::subtract_pivot_row(int rank, int col, const std::vector<char>& used) {
  const double* pivot_row = at(rank, 0);
  const double* pivot_sums = sums_.data() + index(rank) * index(cols_);
  const double* pivot = at(rank, col);
  const int width = static_cast<int>(used.size());
  for (int i = rank + 1; i < rows_; ++i) {
    double* entry = at(i, col);
    if (is_zero(entry)) continue;
    double factor[lanes];
    for (int k = 0; k < lanes; ++k) factor[k] = entry[k] / pivot[k];
    double* sums = sums_.data() + index(i) * index(cols_);
    double* row = at(i, 0);
    for (int j = 0; j < cols_; ++j) {
      if (j < width && used[index(j)] != 0) continue;
      const double* from = pivot_row + j * lanes;
      if (from[0] == 0.0 && is_zero(from)) continue;
      double* to = row + j * lanes;
      for (int k = 0; k < lanes; ++k) to[k] -= factor[k] * from[k];
      sums[j] += std::fabs(factor[0]) * pivot_sums[j];
      clear_rounding_errors(i, j);
    }
    std::fill_n(entry, lanes, 0.0);
  }
}

void LockstepMatrix::drop(int row, int col, Significance& significance) const {
  const double* entry = at(row, col);
  if (is_zero(entry)) return;
  const double* sums = sums_.data() + row * cols_;
  const double sum = *std::max_element(sums, sums + cols_);
  significance.strongest = std::max(significance.strongest, significance_of(entry));
  significance.amplification = std::max(significance.amplification, largest_move(entry) / (trial_perturbation * sum));
}

void LockstepMatrix::drop_rows(int top, int width, Significance& significance, double tolerance) {
  for (int i = top; i < rows_; ++i) {
    bool has_values = false;
    const double* sums = sums_.data() + i * cols_;
    const double zero = tolerance > 0.0 ? tolerance * *std::max_element(sums, sums + cols_) : 0.0;
    for (int j = width; j < cols_ && !has_values; ++j) {
      const double* entry = at(i, j);
      has_values = tolerance > 0.0 ? std::fabs(entry[0]) > zero : entry[0] != 0.0 && significance_of(entry) >= 1.0;
    }
    if (has_values) continue;
    for (int j = width; j < cols_; ++j) {
      drop(i, j, significance);
      std::fill_n(at(i, j), lanes, 0.0);
    }
  }
}

int LockstepMatrix::eliminate(int width, Significance& significance, double tolerance) {
  sums_.resize(index(rows_) * index(cols_));
  double largest = 0.0;
  for (int i = 0; i < rows_; ++i)
    for (int j = 0; j < cols_; ++j) {
      const double size = std::fabs(at(i, j)[0]);
      sums_[index(i) * index(cols_) + index(j)] = size;
      if (j < width) largest = std::max(largest, size);
    }
  std::vector<char> used(index(width), 0);
  int rank = 0;
  for (; rank < std::min(rows_, width); ++rank) {
    const Pivot pivot = tolerance > 0.0 ? find_largest(rank, used, tolerance * largest) : find_pivot(rank, used);
    if (pivot.row < 0) break;
    significance.weakest = std::min(significance.weakest, pivot.significance);
    significance.smallest_pivot = std::min(significance.smallest_pivot, pivot.size / largest);
    swap_rows(rank, pivot.row);
    used[index(pivot.col)] = 1;
    subtract_pivot_row(rank, pivot.col, used);
  }
  for (int i = rank; i < rows_; ++i)
    for (int j = 0; j < width; ++j)
      if (used[index(j)] == 0) drop(i, j, significance);
  drop_rows(rank, width, significance, tolerance);
  return rank;
}

}  // namespace sfdae::core
