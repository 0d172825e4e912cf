// The jump of velocities by impulses of constraints, at fixed positions:
//
//     M (v+ - v-) = -C^T p,   C_i v+ + r_i = -e_i (C_i v- + r_i)
//
// with coefficients of restitution e_i, 0 where a constraint holds from then on.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multibody/multibody_partition.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_problem.h"

namespace sfdae::core {

struct Impact {
  std::vector<double> v;  // after
  std::vector<double> p;  // of all constraints, of least norm where some are redundant
};

// Impact on constraints of this rank. restitution: empty, or one for each. Throws Failure: SFDAE_SINGULAR,
// SFDAE_INCONSISTENT_EQUATIONS if redundant constraints ask for different velocities, errors of callbacks.
Impact impact(MultibodyProblem& problem, const MultibodyPhasePoint& before, int rank,
              const std::vector<double>& restitution);

}  // namespace sfdae::core
