// Monitor of the partition of a mechanical system.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_partition_monitor.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

void PartitionMonitor::resize(const MultibodySizes& sizes, const MultibodySettings& settings) {
  settings_ = settings;
  origin_.q.resize(index(sizes.positions));
  origin_.v.resize(index(sizes.velocities));
}

// A partition is replaced once the constraints have turned from it by more than 45 degrees; partitions by components
// differ by a factor from the beginning (docs/design/multibody.md).
double PartitionMonitor::largest_rotation() const {
  return settings_.coordinates == Coordinates::orthogonal ? 1.0 : 10.0;
}

bool PartitionMonitor::fits(MultibodyLinearization& linearization, Arena& arena) const {
  return count_ > 0 && linearization.build_tangents(arena) &&
         !(linearization.form().tangents().rotation() > largest_rotation());
}

PointStatus PartitionMonitor::choose(MultibodyLinearization& linearization, const MultibodyPoint& accepted,
                                     MultibodyProjection& projection, Arena& arena) {
  found_ = linearization.choose_partition(settings_.coordinates, arena);
  if (!linearization.build_tangents(arena)) return PointStatus::singular;
  const MultibodyPoint& point = linearization.point();
  origin_.t = point.t;
  std::copy(point.q.begin(), point.q.end(), origin_.q.begin());
  std::copy(point.v.begin(), point.v.end(), origin_.v.begin());
  ++count_;
  if (projection.build_tangents(accepted, linearization.form(), arena))
    orientation_ = projection.tangents().orientation();
  return PointStatus::ok;
}

bool PartitionMonitor::has_known_ranks() {
  if (found_ == settings_.ranks) return true;
  change_.ranks = found_;
  return false;
}

PointStatus PartitionMonitor::check(const MultibodyPoint& point, const MultibodyPoint& accepted,
                                    const Tangents& tangents, MultibodyLinearization& linearization, Arena& arena) {
  // Steps that are shorter, relative to t, cannot be shortened much more: constraints that seem to vanish do so.
  constexpr double shortest = 1e-6;
  const MultibodyForm& form = linearization.form();
  const bool has_rotated = tangents.rotation() > largest_rotation();
  if (has_rotated) linearization.chord().set_slow(true);
  end_orientation_ = tangents.orientation();
  Crossings crossings;
  crossings.positions =
      tangents.positions.zero_crossings_from(form.positions(), accepted.position_rows().matrix, arena);
  crossings.velocities = form.tangents().same_rows
                             ? crossings.positions
                             : tangents.velocities.zero_crossings_from(form.velocities(), accepted.terms.C, arena);
  if (end_orientation_ == orientation_ && crossings.positions.count + crossings.velocities.count == 0)
    return PointStatus::ok;
  if (has_rotated && std::fabs(point.t - accepted.t) > shortest * std::fabs(accepted.t) && !has_changed_) {
    linearization.set_valid(false);
    return PointStatus::not_converged;
  }
  note_change(point, crossings, form, arena);
  return PointStatus::changed;
}

PointStatus PartitionMonitor::check_within(const MultibodyOrientation& orientation,
                                           MultibodyLinearization& linearization) const {
  if (orientation == orientation_) return PointStatus::ok;
  linearization.set_valid(false);
  return PointStatus::not_converged;
}

// Finds the constraint that vanishes, in the units of its gradient.
void PartitionMonitor::name_constraint(const MultibodyPoint& point, int turning_row, const MultibodyForm& form,
                                       Arena& arena) {
  // Above this value nothing is small at the point, though it vanishes nearby: the message then names the constraint
  // that turned most.
  constexpr double independent = 0.1;
  MultibodyRankChange found = change_;
  form.judge(point, arena, found.vanishing_row, found.vanishing_value);
  if (found.vanishing_value > independent) {
    found.vanishing_value = 0.0;
    if (turning_row >= 0) found.vanishing_row = turning_row;
  }
  change_ = found;
  has_changed_ = true;
}

void PartitionMonitor::note_change(const MultibodyPoint& point, const Crossings& crossings, const MultibodyForm& form,
                                   Arena& arena) {
  name_constraint(point, crossings.velocities.row, form, arena);
  change_.ranks = settings_.ranks;
  const auto lost = [](bool has_turned_over, int count) { return std::max(count, has_turned_over ? 1 : 0); };
  change_.ranks.velocities -=
      lost(end_orientation_.velocities != orientation_.velocities, crossings.velocities.count);
  change_.ranks.positions -= lost(end_orientation_.positions != orientation_.positions, crossings.positions.count);
}

void PartitionMonitor::note_singularity(const MultibodyPoint& point, const NearbySingularity& singularity,
                                        const MultibodyForm& form, Arena& arena) {
  name_constraint(point, singularity.row, form, arena);
  change_.ranks = settings_.ranks;
  change_.ranks.positions -= singularity.is_of_positions ? 1 : 0;
  change_.ranks.velocities -= singularity.is_of_velocities ? 1 : 0;
}

void PartitionMonitor::accept() {
  orientation_ = end_orientation_;
  has_changed_ = false;
}

void PartitionMonitor::restore(const MultibodyOrientation& orientation, long count) {
  orientation_ = end_orientation_ = orientation;
  count_ = count;
}

std::string PartitionMonitor::message(const MultibodyProblem& problem) const {
  if (!has_changed_) return {};
  const std::string gradient =
      " The configuration is singular: the gradient of " + problem.name_of_constraint(change_.vanishing_row) + " ";
  if (change_.vanishing_value == 0.0) return gradient + "vanishes.";
  return gradient + format("depends on those of the others, with singular value %.2g.", change_.vanishing_value);
}

}  // namespace sfdae::core
