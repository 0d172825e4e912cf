// Independent and dependent directions under constraints C w = b, chosen at one point.
//
// [Q1 Q2] is orthonormal and constant. The columns of Q2 span the range of C^T at that point; for partitions by
// components, Q1 and Q2 are columns of the identity.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "linalg/rank.h"

namespace sfdae::core {

enum class Coordinates { orthogonal, permutation };

// Rows of constraints, row i to be measured in units[i]; 0 for a row that vanishes.
struct ConstraintRows {
  ConstView matrix;
  const double* units;
};

struct Partition {
  void resize(int directions, int constraints);
  ConstView Q1() const { return Q.view().columns(rank, Q.cols() - rank); }
  ConstView Q2() const { return Q.view().columns(0, rank); }
  Matrix Q;  // [Q2 Q1]
  int rank = 0;
  std::vector<int> rows;  // `rank` independent constraints come first
  double rank_tol = 0.0;  // > 0: threshold for zero, rows being of unit length; 0: rounding errors
};

// Chooses directions, and known_rank independent rows; -1: as many as are found. Returns the rank decision.
RankDecision choose_partition(const ConstraintRows& constraints, Coordinates coordinates, int known_rank,
                              Partition& partition, Arena& arena);

}  // namespace sfdae::core
