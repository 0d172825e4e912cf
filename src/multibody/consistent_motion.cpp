// Positions and velocities of mechanical systems made consistent.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/consistent_motion.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "multibody/multibody_consistency.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

bool stays(const double* from, const double* to, int count) {
  // Relative to the largest of them.
  constexpr double largest_move = 1e-13;
  const double bound = largest_move * max_abs(from, count);
  for (int i = 0; i < count; ++i)
    if (!(std::fabs(to[i] - from[i]) <= bound)) return false;
  return true;
}

}  // namespace

std::vector<double> with_consistent_motion(MultibodyProblem& problem, const PointOfInterest& point,
                                           const ModelOptions& options) {
  const MultibodySizes& sizes = problem.sizes();
  const ConsistencyRequest request = options.request_at(point.x);
  MultibodyConsistency consistency(problem, point.t, request, options.ignore_inconsistency);
  const std::vector<double> q = consistency.positions(point.x);
  const std::vector<double> v = consistency.velocities(q, point.x + sizes.positions, sizes.constraints());
  std::vector<double> x(point.x, point.x + sizes.unknowns());
  std::copy(q.begin(), q.end(), x.begin());
  std::copy(v.begin(), v.end(), x.begin() + sizes.positions);
  return x;
}

bool motion_stays(const MultibodySizes& sizes, const std::vector<double>& from, const std::vector<double>& to) {
  const int nq = sizes.positions;
  return stays(from.data(), to.data(), nq) && stays(from.data() + nq, to.data() + nq, sizes.velocities);
}

ConstraintsReport constraints_at(MultibodyProblem& problem, const Jet& jet) {
  const MultibodySizes& sizes = problem.sizes();
  MultibodyPoint point;
  point.resize(sizes);
  point.set(jet.t, jet.x.data(), jet.x.data() + sizes.positions);
  const CallbackError error = problem.at_velocity(point.t, point.q.data(), point.v.data(), point.terms);
  if (error.status != SFDAE_OK) error.raise();
  point.measure_rows();
  return {.t = point.t,
          .holonomic = sizes.holonomic,
          .nonholonomic = sizes.nonholonomic,
          .redundant = 0,
          .degrees_of_freedom = sizes.velocities - sizes.constraints(),
          .position_freedom = sizes.positions - sizes.holonomic,
          .condition = condition_of_constraints(point),
          .partitions = 0,
          .position_residual = position_residual(point),
          .velocity_residual = velocity_residual(point)};
}

}  // namespace sfdae::core
