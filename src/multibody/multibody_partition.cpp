// Independent and dependent directions under constraints.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_partition.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Rounding errors in rows of unit length that depend on each other; gradients are sums of products.
constexpr double row_noise = 8.0 * unit_roundoff;

// Columns of the identity: dependent components by the pivots of the independent rows.
void choose_components(View rows, Partition& partition, Arena& arena) {
  const Arena::Frame frame(arena);
  const int n = rows.cols;
  int* pivots = arena.integers(n);
  std::iota(pivots, pivots + n, 0);
  if (rows.rows > 0) factor_qr_pivoted(rows, pivots, arena.take(index(n) + 1), arena);
  fill(partition.Q, 0.0);
  for (int j = 0; j < n; ++j) partition.Q(pivots[j], j) = 1.0;
}

}  // namespace

void Partition::resize(int directions, int constraints) {
  Q = identity(directions);
  rank = 0;
  rows.resize(index(constraints));
  std::iota(rows.begin(), rows.end(), 0);
}

RankDecision choose_partition(const ConstraintRows& constraints, Coordinates coordinates, int known_rank,
                              Partition& partition, Arena& arena) {
  const int n = partition.Q.rows(), count = constraints.matrix.rows;
  const Arena::Frame frame(arena);
  const View gradients = arena.matrix(n, count);
  double* tau = arena.take(index(std::max(n, count)) + 1);
  for (int i = 0; i < count; ++i) {
    const double scale = constraints.units[i] > 0.0 ? 1.0 / constraints.units[i] : 0.0;
    for (int j = 0; j < n; ++j) gradients(j, i) = scale * constraints.matrix(i, j);
  }
  factor_qr_pivoted(gradients, partition.rows.data(), tau, arena);
  RankScale scale;
  scale.noise = row_noise;
  scale.dimension = std::max(n, count);
  scale.rank_tol = partition.rank_tol;
  RankDecision decision = decide_rank(gradients.data, std::min(n, count), gradients.ld + 1, scale);
  decision.subject = Subject::constraints;
  decision.rows = count;
  decision.cols = n;
  partition.rank = known_rank >= 0 ? known_rank : decision.rank;
  if (coordinates == Coordinates::orthogonal) {
    form_q(gradients, partition.rank, tau, partition.Q, arena);
  } else {
    const View rows = arena.matrix(partition.rank, n);
    for (int k = 0; k < partition.rank; ++k) {
      const int i = partition.rows[index(k)];
      for (int j = 0; j < n; ++j) rows(k, j) = constraints.matrix(i, j) / constraints.units[i];
    }
    choose_components(rows, partition, arena);
  }
  return decision;
}

}  // namespace sfdae::core
