// The linearization of a mechanical system that steps are solved with: its point, its Jacobian, its form in local
// coordinates, the matrix of a step, and the convergence of its chord iteration.
//
// It is reused from step to step while convergence is good enough.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multibody/multibody_equations.h"
#include "multibody/multibody_form.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_ranks.h"
#include "multibody/multibody_renewal.h"
#include "multibody/multibody_step_matrix.h"
#include "system/chord_iteration.h"

namespace sfdae::core {

class MultibodyLinearization {
 public:
  // Allocates memory for these sizes.
  void resize(const MultibodySizes& sizes, const MultibodySettings& settings);

  // Moves to another point, with all its terms or those that a partition needs; the former linearization becomes
  // invalid.
  PointStatus move_to(double t, const double* q, const double* v, MultibodyEquations& equations);
  PointStatus move_to_position(double t, const double* q, const double* v, MultibodyEquations& equations);
  void move_to(const MultibodyPoint& point) { point_ = point; }
  // T and N at the point. False if the partition does not fit it at all.
  bool build_tangents(Arena& arena) { return form_.build_tangents(point_, arena); }
  // New partitions at the point, and the ranks found.
  MultibodyRanks choose_partition(Coordinates coordinates, Arena& arena);
  // Linearizes there, after build_tangents.
  PointStatus build(MultibodyEquations& equations, Arena& arena);

  const MultibodyPoint& point() const { return point_; }
  const MultibodyForm& form() const { return form_; }
  bool is_valid() const { return is_valid_; }
  void set_valid(bool is_valid) { is_valid_ = is_valid; }
  MultibodyStepMatrix& matrix() { return matrix_; }
  const MultibodyStepMatrix& matrix() const { return matrix_; }
  ChordIteration& chord() { return chord_; }
  const ChordIteration& chord() const { return chord_; }
  MultibodyRenewal& renewal() { return renewal_; }

  // After a step of s stages has converged: decides whether the next one gets a new linearization.
  void count_iterations(int s, int iterations);

  // Changes of mu, of least norm, that belong to changes of q and v, a column for each.
  void change_of_forces(ConstView dqv, View dmu, Arena& arena) const;
  // Errors of mu that belong to errors yz of local coordinates; these are overwritten.
  void error_of_forces(View yz, View dmu, Arena& arena) const;

 private:
  MultibodyPoint point_;
  MultibodyJacobian jacobian_;
  MultibodyForm form_;
  MultibodyStepMatrix matrix_;
  ChordIteration chord_;
  MultibodyRenewal renewal_;
  bool is_valid_ = false;
};

}  // namespace sfdae::core
