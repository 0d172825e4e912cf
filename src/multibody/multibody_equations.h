// The equations of a mechanical system evaluated at points: terms, derivatives, accelerations.
//
// The owner receives errors of callbacks and counts of factorizations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "multibody/multibody_form.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_problem.h"
#include "multibody/multibody_ranks.h"
#include "system/dae_system.h"

namespace sfdae::core {

class MultibodyEquations {
 public:
  // error: of the last callback. Both arguments must outlive this object.
  MultibodyEquations(MultibodyProblem& problem, CallbackError& error, SystemCounts& counts)
      : problem_(problem), error_(error), counts_(counts) {}
  MultibodyEquations(const MultibodyEquations&) = delete;
  MultibodyEquations& operator=(const MultibodyEquations&) = delete;

  // The ranks decide which method for accelerations is cheaper.
  void set_ranks(const MultibodyRanks& ranks);
  bool solves_along_tangents() const { return along_tangents_; }

  const MultibodyProblem& problem() const { return problem_; }
  const MultibodySizes& sizes() const { return problem_.sizes(); }
  const CallbackError& error() const { return error_; }
  SystemCounts& counts() { return counts_; }

  // Terms at the point: g alone; all except f and s; all.
  PointStatus constraints(MultibodyPoint& point);
  // g and C v + r of the point, with g_q in its terms if wanted; none: see MultibodyProblem.
  std::optional<PointStatus> both_levels(MultibodyPoint& point, bool with_gradients, double* residuals);
  PointStatus at_position(MultibodyPoint& point);
  PointStatus at_velocity(MultibodyPoint& point);
  // All terms at several points; false if one of them has to be evaluated alone.
  bool has_lanes() const { return problem_.has_lanes(); }
  void prepare_lanes(MultibodyLaneTerms& terms) { problem_.prepare_lanes(terms); }
  bool at_velocities(int count, const LaneBlock* t, const LaneBlock* qv, MultibodyLaneTerms& terms) {
    return problem_.at_velocities(count, t, qv, terms);
  }
  // Derivatives for the a and mu of the point.
  PointStatus derivatives(const MultibodyPoint& point, MultibodyJacobian& jacobian);

  // Terms, a and mu of the point, by factors of K.
  PointStatus evaluate(MultibodyPoint& point, const Partition& partition);
  // a and mu of the point, with known terms and this tangent of the constraints on velocities, by the cheapest accurate
  // method.
  PointStatus accelerations(MultibodyPoint& point, const Partition& partition, Tangent& tangent, Arena& arena);

 private:
  PointStatus status() const { return error_.status == SFDAE_OK ? PointStatus::ok : PointStatus::callback_error; }

  MultibodyProblem& problem_;
  CallbackError& error_;
  SystemCounts& counts_;
  bool along_tangents_ = false;
};

}  // namespace sfdae::core
