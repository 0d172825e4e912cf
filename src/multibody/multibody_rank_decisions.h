// Rank decisions of a mechanical system at one point: of its constraints, and of [M C^T; C 0].
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/rank.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_ranks.h"

namespace sfdae::core {

// point: rows measured. rank_tol: as of partitions. decisions (null: not wanted): gets one for each level; if given,
// throws Failure if one is unclear.
MultibodyRanks ranks_of_constraints(const MultibodyPoint& point, double rank_tol,
                                    std::vector<RankDecision>* decisions, Arena& arena);

// The rank of M. Throws Failure if [M C^T; C 0], with so many independent rows of C and every unknown in its unit, is
// singular; the decision is appended.
int check_acceleration_matrix(const MultibodyPoint& point, int rank, std::vector<RankDecision>& decisions,
                              Arena& arena);

}  // namespace sfdae::core
