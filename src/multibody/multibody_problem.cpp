// Base of problems with mechanical systems.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_problem.h"

#include "linalg/index.h"
#include "multibody/multibody_partition.h"
#include "multibody/multibody_point.h"

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

std::string MultibodyProblem::about_singular_point(double t, const double* x) {
  if (sizes_.constraints() == 0) return {};
  MultibodyPoint point;
  point.resize(sizes_);
  point.set(t, x, x + sizes_.positions);
  if (at_velocity(t, point.q.data(), point.v.data(), point.terms).status != SFDAE_OK) return {};
  point.measure_rows();
  Arena arena;
  Partition trial;
  trial.resize(sizes_.velocities, sizes_.constraints());
  const RankDecision decision = choose_partition(point.velocity_rows(), Coordinates::orthogonal, -1, trial, arena);
  const bool is_lost = decision.rank < sizes_.constraints();
  const int row = trial.rows[index(is_lost ? decision.rank : decision.rank - 1)];
  return format(
      " The configuration is singular, or about to be: the gradient of %s depends most on those of the others, %.2g "
      "of its "
      "length is left at t = %.12g, where the condition of the constraints is %.2g.",
      name_of_constraint(row).c_str(), is_lost ? decision.dropped : decision.kept, t,
      condition_of_constraints(point));
}

}  // namespace sfdae::core
