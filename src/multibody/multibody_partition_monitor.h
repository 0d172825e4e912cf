// Monitor of the partition of a mechanical system: its point, whether constraints have turned too far from it, and
// whether their ranks have changed within a step.
//
// A configuration between the ends of a step is singular where det C Q2 changes its sign, unless the constraints have
// turned too far from the partition for this test. If two mechanisms are singular at once, the sign does not change, so
// the zero crossings of all combinations of constraints are counted
// (docs/design/singular_points.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "multibody/multibody_linearization.h"
#include "multibody/multibody_projection.h"
#include "multibody/multibody_ranks.h"
#include "multibody/multibody_singularity.h"
#include "system/dae_system.h"

namespace sfdae::core {

// A change of ranks: the ranks beyond it, and the constraint that vanishes relative to others, or altogether.
struct MultibodyRankChange {
  MultibodyRanks ranks;
  int vanishing_row = -1;
  double vanishing_value = 0.0;
};

class PartitionMonitor {
 public:
  void resize(const MultibodySizes& sizes, const MultibodySettings& settings);

  // The next partition is the first one.
  void forget() { count_ = 0; }
  // T and N at the point of the linearization. False if there is no partition that fits it.
  bool fits(MultibodyLinearization& linearization, Arena& arena) const;
  // A new partition there. The tangents of the projection become those of the point accepted last.
  PointStatus choose(MultibodyLinearization& linearization, const MultibodyPoint& accepted,
                     MultibodyProjection& projection, Arena& arena);
  // Returns whether the partition has the known ranks; if not, its ranks are the change.
  bool has_known_ranks();
  long count() const { return count_; }

  // The first point, projected, is the one accepted last.
  void start(const Tangents& tangents) { end_orientation_ = orientation_ = tangents.orientation(); }
  // After a step from the accepted point to a projected one: checks whether ranks have changed. Reports not_converged
  // if only a shorter step can show that.
  PointStatus check(const MultibodyPoint& point, const MultibodyPoint& accepted, const Tangents& tangents,
                    MultibodyLinearization& linearization, Arena& arena);
  // At a stage within the step: reports not_converged if constraints have turned over, and only shorter steps can show
  // their behavior up to its end.
  PointStatus check_within(const MultibodyOrientation& orientation, MultibodyLinearization& linearization) const;
  // Notes a singular configuration near a point, which steps do not reach.
  void note_singularity(const MultibodyPoint& point, const NearbySingularity& singularity, const MultibodyForm& form,
                        Arena& arena);
  void accept();

  // Returns whether ranks have changed since the point accepted last.
  bool has_changed() const { return has_changed_; }
  // The last change.
  const MultibodyRankChange& change() const { return change_; }
  // Message about the change; empty: none.
  std::string message(const MultibodyProblem& problem) const;

  const MultibodyOrientation& orientation() const { return orientation_; }
  // Restores a partition that was chosen before.
  void restore(const MultibodyOrientation& orientation, long count);
  // Point at which the partition was chosen.
  MultibodyPhasePoint& origin() { return origin_; }

 private:
  // Zero crossings of constraints from one point to another.
  struct Crossings {
    Tangent::ZeroCrossings positions, velocities;
  };

  double largest_rotation() const;
  void name_constraint(const MultibodyPoint& point, int turning_row, const MultibodyForm& form, Arena& arena);
  void note_change(const MultibodyPoint& point, const Crossings& crossings, const MultibodyForm& form, Arena& arena);

  MultibodySettings settings_;
  MultibodyPhasePoint origin_;
  long count_ = 0;
  MultibodyRanks found_;  // when the partition was chosen
  // Orientations at the point accepted last, and at the one checked last.
  MultibodyOrientation orientation_, end_orientation_;
  MultibodyRankChange change_;
  bool has_changed_ = false;
};

}  // namespace sfdae::core
