// The singular configuration of a mechanical system nearest in time, estimated from one point.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_singularity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

struct Zero {
  double tau = std::numeric_limits<double>::infinity();
  int row = -1;
};

// The nearest zero of a combination of the rows C + tau C', and the row that changes most.
Zero nearest_zero(const ConstraintRows& rows, ConstView rates, int rank, Arena& arena) {
  Zero zero;
  if (rank == 0) return zero;
  Partition partition;
  partition.resize(rows.matrix.cols, rows.matrix.rows);
  choose_partition(rows, Coordinates::orthogonal, rank, partition, arena);
  Tangent tangent;
  tangent.resize(rows.matrix.cols, rows.matrix.rows);
  if (!tangent.fit(partition, rows)) return {0.0, partition.rows[index(rank - 1)]};
  const double mu = tangent.fastest_change(partition, rates, zero.row, arena);
  if (mu != 0.0) zero.tau = -1.0 / mu;
  return zero;
}

void differentiate(const Matrix& here, double step, Matrix& there) {
  for (int j = 0; j < here.cols(); ++j)
    for (int i = 0; i < here.rows(); ++i) there(i, j) = (there(i, j) - here(i, j)) / step;
}

}  // namespace

NearbySingularity nearby_singularity(const MultibodyPoint& point, const MultibodyRanks& ranks,
                                     MultibodyEquations& equations, Arena& arena) {
  // Relative to the largest position, or to t if nothing moves, as differences of the first order need.
  constexpr double relative_step = 1e-7;
  // Both levels are singular together if their times agree to that factor.
  constexpr double together = 2.0;
  MultibodyPoint beside(point);
  std::vector<double> rates(point.q.size());
  point.rates(rates.data());
  const double size = max_abs(point.q), speed = max_abs(rates),
               step = relative_step * (size > 0.0 && speed > 0.0 ? size / speed : std::max(1.0, std::fabs(point.t)));
  beside.t += step;
  for (std::size_t i = 0; i < rates.size(); ++i) beside.q[i] += step * rates[i];
  if (equations.at_position(beside) != PointStatus::ok) return {std::numeric_limits<double>::infinity()};
  differentiate(point.terms.g_q, beside.t - point.t, beside.terms.g_q);
  differentiate(point.terms.C, beside.t - point.t, beside.terms.C);
  const Zero positions = nearest_zero(point.position_rows(), beside.terms.g_q, ranks.positions, arena),
             velocities = nearest_zero(point.velocity_rows(), beside.terms.C, ranks.velocities, arena);
  const double at_positions = std::fabs(positions.tau), at_velocities = std::fabs(velocities.tau);
  const Zero& nearest = at_velocities <= at_positions ? velocities : positions;
  const double limit = together * std::fabs(nearest.tau);
  return {point.t + nearest.tau, nearest.row, at_positions <= limit, at_velocities <= limit};
}

}  // namespace sfdae::core
