// The jump of velocities by impulses of constraints.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_impact.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Required changes of C_i v + r_i.
Vector wanted_changes(const MultibodyPoint& point, const Vector& restitution) {
  Vector rates(index(point.terms.C.rows()) + 1);
  point.velocity_residuals(rates.data());
  rates.pop_back();
  for (std::size_t i = 0; i < rates.size(); ++i) rates[i] *= -(1.0 + (restitution.empty() ? 0.0 : restitution[i]));
  return rates;
}

// Checks the changes of redundant constraints, too.
void demand_changes(const MultibodyProblem& problem, const MultibodyPoint& point, const Vector& wanted,
                    const Vector& dv) {
  // Relative to velocities; rounding errors are smaller by orders of magnitude.
  constexpr double contradiction = 1e-9;
  Vector left(wanted);
  if (!left.empty()) multiply(1.0, Op::plain, point.terms.C, dv.data(), -1.0, left.data());
  const double size =
      std::max(max_abs(dv.data(), static_cast<int>(dv.size())), max_abs(point.v.data(), static_cast<int>(dv.size())));
  for (std::size_t i = 0; i < left.size(); ++i)
    if (std::fabs(left[i]) > contradiction * point.velocity_units[i] * size + 1e-12 * std::fabs(wanted[i]))
      throw Failure(SFDAE_INCONSISTENT_EQUATIONS,
                    format("the constraints ask for different velocities after the impact at t = %.15g: %s, which "
                           "depends on others, is off by %.3g. Take the same coefficient of restitution for them.",
                           point.t, problem.name_of_constraint(static_cast<int>(i)).c_str(), left[i]));
}

}  // namespace

Impact impact(MultibodyProblem& problem, const MultibodyPhasePoint& before, int rank, const Vector& restitution) {
  const MultibodySizes& sizes = problem.sizes();
  const int nv = sizes.velocities;
  MultibodyPoint point;
  point.resize(sizes);
  point.set(before.t, before.q.data(), before.v.data());
  const CallbackError error = problem.at_velocity(point.t, point.q.data(), point.v.data(), point.terms);
  if (error.status != SFDAE_OK) error.raise();
  point.measure_rows();
  Impact result{point.v, Vector(index(sizes.constraints()), 0.0)};
  if (rank == 0) return result;
  Arena arena;
  Partition partition;
  partition.resize(nv, sizes.constraints());
  choose_partition(point.velocity_rows(), Coordinates::orthogonal, rank, partition, arena);
  if (!point.factor(partition.rows, rank))
    throw Failure(SFDAE_SINGULAR,
                  format("the impact at t = %.15g is not determined: [M C^T; C 0] is singular.", before.t));
  const Vector wanted = wanted_changes(point, restitution);
  Vector change(index(nv + rank), 0.0);
  for (int k = 0; k < rank; ++k) change[index(nv + k)] = wanted[index(partition.rows[index(k)])];
  point.solve(change.data());
  for (int k = 0; k < rank; ++k) result.p[index(partition.rows[index(k)])] = change[index(nv + k)];
  change.resize(index(nv));
  demand_changes(problem, point, wanted, change);
  for (int i = 0; i < nv; ++i) result.v[index(i)] += change[index(i)];
  point.take_least_norm(partition, result.p.data(), arena);
  return result;
}

}  // namespace sfdae::core
