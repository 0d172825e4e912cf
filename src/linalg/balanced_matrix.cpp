// Matrices in balanced units.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/balanced_matrix.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "linalg/arena.h"
#include "linalg/dense.h"
#include "linalg/equilibration.h"
#include "linalg/unit_fit.h"

namespace sfdae::core {

namespace {

// Largest deviation of entries from 1, in bits, that balanced units may leave.
constexpr double similar_size = 12.0;
// Pivots below that, in such units, are useless for steps even if they are certain (docs/design/scaling_and_units.md).
constexpr double useful_pivot = 1e-10;

// A single matrix leaves no unit of time.
constexpr std::size_t only = 1;

EntrySizes sizes_of(const Matrix& J) {
  EntrySizes sizes(J.rows(), J.cols());
  EntrySizes::Block& entries = sizes.blocks[only];
  for (int j = 0; j < J.cols(); ++j)
    for (int i = 0; i < J.rows(); ++i) {
      if (J(i, j) == 0.0) continue;
      entries.bits(i, j) = std::log2(std::fabs(J(i, j)));
      entries.counts(i, j) = 1.0;
    }
  return sizes;
}

RankDecision decision_on(Matrix J, double noise) {
  const int size = J.rows();
  Arena arena;
  std::vector<int> pivots(index(size));
  std::vector<double> tau(index(size));
  factor_qr_pivoted(J, pivots.data(), tau.data(), arena);
  return decide_rank(J.data(), size, size + 1, {.noise = noise, .norm = std::fabs(J(0, 0)), .dimension = size});
}

bool is_useful(const RankDecision& decision, int size) {
  return decision.rank == size && decision.verdict == Verdict::clear && decision.kept >= useful_pivot;
}

int rounded(double exponent) { return static_cast<int>(std::lround(exponent)); }

}  // namespace

bool balance(Matrix& J, Matrix& changes, Matrix& without_suspects) {
  EntrySizes sizes = sizes_of(J);
  EntrySizes::Block& entries = sizes.blocks[only];
  UnitExponents units(J.rows(), J.cols());
  const auto left = [&](int i, int j) { return entries.bits(i, j) + units.sum_at(entries, i, j); };
  // Entries that are too small are excluded from the units one by one: the worst one distorts all others.
  const int most_suspects = J.rows();
  for (int suspects = 0;; ++suspects) {
    fit_squares(sizes, units);
    double smallest = 0.0, largest = 0.0;
    int row = 0, column = 0;
    for (int j = 0; j < J.cols(); ++j)
      for (int i = 0; i < J.rows(); ++i) {
        if (entries.counts(i, j) == 0.0) continue;
        largest = std::max(largest, left(i, j));
        if (left(i, j) < smallest) smallest = left(i, j), row = i, column = j;
      }
    if (std::max(largest, -smallest) <= similar_size) break;
    if (-smallest <= similar_size || suspects == most_suspects) return false;
    entries.counts(row, column) = 0.0;
  }
  // Powers of two: with other factors, rounding errors would hide linear dependence of rows.
  without_suspects = Matrix(J.rows(), J.cols());
  for (int j = 0; j < J.cols(); ++j)
    for (int i = 0; i < J.rows(); ++i) {
      const int exponent = rounded(units.rows[index(i)]) + rounded(units.unknowns[index(j)]);
      J(i, j) = times_power_of_two(J(i, j), exponent);
      changes(i, j) = times_power_of_two(changes(i, j), exponent);
      if (entries.counts(i, j) > 0.0) without_suspects(i, j) = J(i, j);
    }
  return true;
}

bool is_regular_in_balanced_units(Matrix& J, Matrix changes, RankDecision& decision) {
  Matrix without_suspects;
  if (!balance(J, changes, without_suspects)) return false;
  const int size = J.rows();
  const double noise = std::max(unit_roundoff, max_abs(changes));
  RankDecision found = decision_on(J, noise);
  if (!is_useful(found, size) || !is_useful(decision_on(std::move(without_suspects), noise), size)) return false;
  found.t = decision.t;
  found.level = decision.level;
  found.stage = decision.stage;
  found.subject = decision.subject;
  found.rows = found.cols = size;
  decision = found;
  return true;
}

}  // namespace sfdae::core
