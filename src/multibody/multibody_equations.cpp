// The equations of a mechanical system evaluated at points.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_equations.h"

#include <cmath>

namespace sfdae::core {

void MultibodyEquations::set_ranks(const MultibodyRanks& ranks) {
  // Floating-point operations of T^T M T, products and factors, and of factors of K; by a fifth less, as they are
  // counted to leading order only.
  constexpr double worthwhile = 1.2;
  const double nv = sizes().velocities, r = ranks.velocities, open = nv - r;
  const double along = 2.0 * nv * open * (nv + open) + 2.0 / 3.0 * std::pow(open, 3),
               whole = 2.0 / 3.0 * std::pow(nv + r, 3);
  along_tangents_ = r > 0 && worthwhile * along < whole;
}

PointStatus MultibodyEquations::constraints(MultibodyPoint& point) {
  error_ = problem_.constraints(point.t, point.q.data(), point.terms.g.data());
  return status();
}

std::optional<PointStatus> MultibodyEquations::both_levels(MultibodyPoint& point, bool with_gradients,
                                                           double* residuals) {
  Matrix* const g_q = with_gradients ? &point.terms.g_q : nullptr;
  if (!problem_.constraints_on_both_levels({point.t, point.q.data(), point.v.data(), residuals, g_q}, error_))
    return std::nullopt;
  return status();
}

PointStatus MultibodyEquations::at_position(MultibodyPoint& point) {
  error_ = problem_.at_position(point.t, point.q.data(), point.terms);
  return status();
}

PointStatus MultibodyEquations::at_velocity(MultibodyPoint& point) {
  error_ = problem_.at_velocity(point.t, point.q.data(), point.v.data(), point.terms);
  return status();
}

PointStatus MultibodyEquations::derivatives(const MultibodyPoint& point, MultibodyJacobian& jacobian) {
  error_ = problem_.linearize(point.state(), point.terms, jacobian);
  return status();
}

PointStatus MultibodyEquations::evaluate(MultibodyPoint& point, const Partition& partition) {
  const PointStatus status = at_velocity(point);
  if (status != PointStatus::ok) return status;
  ++counts_.factorizations;
  if (!point.factor(partition.rows, partition.rank)) return PointStatus::singular;
  point.solve_accelerations(partition.rows, partition.rank);
  return PointStatus::ok;
}

PointStatus MultibodyEquations::accelerations(MultibodyPoint& point, const Partition& partition, Tangent& tangent,
                                              Arena& arena) {
  ++counts_.factorizations;
  if (tangent.smallest_pivot() > smallest_pivot_with_masses && point.solve_by_masses(partition, tangent, arena))
    return PointStatus::ok;
  if (along_tangents_) {
    if (!tangent.is_complete()) tangent.complete(partition, arena);
    return point.solve_along(partition, tangent, arena) ? PointStatus::ok : PointStatus::singular;
  }
  if (!point.factor(partition.rows, partition.rank)) return PointStatus::singular;
  point.solve_accelerations(partition.rows, partition.rank);
  return PointStatus::ok;
}

}  // namespace sfdae::core
