// The chord iteration for the stages of a step of a mechanical system.
//
// With (y_i, z_i) the changes of stage i in local coordinates and p_i = -N (residuals) its particular change, the
// stages are
//
//     sum_j D_ij / h (y_j, z_j) - B (y_i, z_i) = (Q_q1^T S v_i, Q_v1^T a_i) + (those of p_i) - (Q1^T D_h w)_i
//
// where Q1^T p_i = 0. Accelerations are exact in every iteration.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multibody/multibody_equations.h"
#include "multibody/multibody_lanes.h"
#include "multibody/multibody_linearization.h"
#include "multibody/multibody_noise.h"
#include "multibody/multibody_stages.h"

namespace sfdae::core {

class MultibodyIteration {
 public:
  // Objects that the iteration uses.
  struct Parts {
    MultibodyEquations& equations;
    MultibodyLinearization& linearization;
    MultibodyNoise& noise;
    MultibodyStages& stages;
    MultibodyLanes& lanes;
    Arena& arena;
  };
  // inverse_weights: of (q, v).
  MultibodyIteration(const MultibodyDiscretization& discretization, const double* inverse_weights, const Parts& parts)
      : discretization_(discretization), inverse_weights_(inverse_weights), parts_(parts) {}

  // Starts from the values of the stages, which become the solution.
  PointStatus run();

  // For the chord iteration.
  std::size_t num_rows() const { return index(discretization_.s) * index(parts_.linearization.form().unknowns()); }
  PointStatus evaluate(double* rows);
  void add(RowSums kind, double* rows);
  double change(const double* rows);
  bool may_end(int) {
    ++iterations_;
    return true;
  }

 private:
  bool factor();
  void begin_lanes();
  PointStatus evaluate_stage(int i);
  PointStatus evaluate_columns();
  void copy_rows(double* rows);
  void start_moves(int i);
  void complete_residuals();
  void project_sizes(const double* of_qv, double* local) const;
  void change_columns();
  void finish();
  double norm_of(const double* change) const;

  const MultibodyDiscretization& discretization_;
  const double* inverse_weights_;
  Parts parts_;
  bool in_lanes_ = false;   // all stages at once, in parts_.lanes
  bool has_moves_ = false;  // in the columns
  int iterations_ = 0;
};

}  // namespace sfdae::core
