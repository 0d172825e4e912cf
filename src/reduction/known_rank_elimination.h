// Elimination of a matrix and of perturbed copies whose rank norms have suggested.
//
// The copies show if a rank is certain (lockstep_elimination.h), with any large pivots. If the rank is known, entries
// need not be searched for by their significance: pivoted QR chooses columns, partial pivoting rows, the same ones in
// all copies, and products of matrices do the rest (docs/design/rank_decisions.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reduction/lockstep_elimination.h"

namespace sfdae::core {

// Equations and unknowns from which on the ranks of norms are confirmed before others are searched for: below, the
// search takes 20 ms at most.
inline constexpr int large_problem = 64;

// LockstepMatrix::eliminate with `rank` pivots in the first `width` columns. If there are fewer pivots,
// significance.weakest becomes 0.
void eliminate_with_rank(LockstepMatrix& matrix, int width, int rank, Significance& significance,
                         ZeroScale scale = ZeroScale::whole_rows);

}  // namespace sfdae::core
