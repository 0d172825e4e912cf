// The linearization of a mechanical system that steps are solved with.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_linearization.h"

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

void MultibodyLinearization::resize(const MultibodySizes& sizes, const MultibodySettings& settings) {
  form_.resize(sizes, settings.ranks.positions, settings.ranks.velocities);
  form_.set_rank_tol(settings.rank_tol);
  jacobian_ = MultibodyJacobian(sizes);
  point_.resize(sizes);
  matrix_.resize(form_.unknowns());
}

PointStatus MultibodyLinearization::move_to(double t, const double* q, const double* v,
                                            MultibodyEquations& equations) {
  is_valid_ = false;
  matrix_.forget();
  point_.set(t, q, v);
  const PointStatus status = equations.at_velocity(point_);
  if (status == PointStatus::ok) point_.measure_rows();
  return status;
}

PointStatus MultibodyLinearization::move_to_position(double t, const double* q, const double* v,
                                                     MultibodyEquations& equations) {
  is_valid_ = false;
  point_.set(t, q, v);
  const PointStatus status = equations.at_position(point_);
  if (status == PointStatus::ok) point_.measure_rows();
  return status;
}

MultibodyRanks MultibodyLinearization::choose_partition(Coordinates coordinates, Arena& arena) {
  const MultibodyForm::Ranks found = form_.choose(point_, coordinates, arena);
  return {found.positions.rank, found.velocities.rank};
}

PointStatus MultibodyLinearization::build(MultibodyEquations& equations, Arena& arena) {
  const Partition& partition = form_.velocities();
  if (!point_.factor(partition.rows, partition.rank)) return PointStatus::singular;
  point_.solve_accelerations(partition.rows, partition.rank);
  const PointStatus status = equations.derivatives(point_, jacobian_);
  if (status != PointStatus::ok) return status;
  form_.build(point_, jacobian_, arena);
  ++equations.counts().reductions;
  ++equations.counts().factorizations;
  is_valid_ = true;
  renewal_.begin();
  chord_.forget_rate();
  return PointStatus::ok;
}

void MultibodyLinearization::count_iterations(int s, int iterations) {
  // Measured cost of a linearization in evaluations of one stage: its linear algebra grows faster than theirs.
  const double cost = 2.0 + form_.unknowns() / 8.0;
  if (renewal_.pays(s, iterations, cost)) chord_.set_slow(true);
}

// Uses (I - B / c)^-1 yz in place of yz: components that are stiff over the step have hardly any error, but mu depends
// on them strongly.
void MultibodyLinearization::error_of_forces(View yz, View dmu, Arena& arena) const {
  const int d = form_.unknowns(), count = yz.cols;
  if (d == 0) return fill(dmu, 0.0);
  const Arena::Frame frame(arena);
  const View dqv = arena.matrix(static_cast<int>(point_.q.size() + point_.v.size()), count);
  if (matrix_.is_valid()) {
    matrix_.solve(yz);
    for (int j = 0; j < count; ++j)
      for (int k = 0; k < d; ++k) yz(k, j) *= matrix_.c();
  }
  form_.expand(yz, dqv);
  change_of_forces(dqv, dmu, arena);
}

void MultibodyLinearization::change_of_forces(ConstView dqv, View dmu, Arena& arena) const {
  const Partition& partition = form_.velocities();
  const int r = partition.rank, count = dqv.cols;
  fill(dmu, 0.0);
  if (r == 0) return;
  const Arena::Frame frame(arena);
  const View independent = arena.matrix(r, count);
  form_.forces(dqv, independent);
  for (int j = 0; j < count; ++j)
    for (int k = 0; k < r; ++k) dmu(partition.rows[index(k)], j) = independent(k, j);
  // Least norm as for mu itself: with other units of the constraints the undetermined part may be by far the largest.
  for (int j = 0; j < count; ++j) point_.take_least_norm(partition, dmu.column(j), arena);
}

}  // namespace sfdae::core
