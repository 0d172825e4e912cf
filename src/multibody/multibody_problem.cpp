// What problems with mechanical systems deliver.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_problem.h"

#include "linalg/index.h"

namespace sfdae::core {

MultibodyTerms::MultibodyTerms(const MultibodySizes& sizes)
    : M(sizes.velocities, sizes.velocities),
      g_q(sizes.holonomic, sizes.positions),
      C(sizes.constraints(), sizes.velocities),
      g(index(sizes.holonomic)),
      f(index(sizes.velocities)),
      velocity_rest(index(sizes.constraints())),
      acceleration_rest(index(sizes.constraints())) {}

MultibodyJacobian::MultibodyJacobian(const MultibodySizes& sizes)
    : force_q(sizes.velocities, sizes.positions),
      force_v(sizes.velocities, sizes.velocities),
      acceleration_q(sizes.constraints(), sizes.positions),
      acceleration_v(sizes.constraints(), sizes.velocities),
      velocity_q(sizes.constraints(), sizes.positions) {}

}  // namespace sfdae::core
