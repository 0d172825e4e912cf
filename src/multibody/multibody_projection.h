// Nearby points at which the constraints of a mechanical system hold on both levels.
//
// Only the dependent directions of the partition move: Q_q2 until g = 0 to machine precision, then Q_v2 until C v + r =
// 0. Accelerations and forces are those of the resulting point.
//
// Outputs are frequent: Newton's method on both levels at once comes so close that terms are evaluated only once
// (docs/design/iteration_matrices.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "multibody/multibody_equations.h"
#include "multibody/multibody_form.h"
#include "multibody/multibody_point.h"

namespace sfdae::core {

class MultibodyProjection {
 public:
  void resize(const MultibodySizes& sizes, const MultibodyForm& form);
  // Weights of (q, v): an error of one unit is as large as the tolerance. 0, before weights are set, for no tolerance.
  void set_weights(const double* inverse_weights);

  // Parts that move; positions that stay are those of a point with terms and rows. rest: velocities, which approach()
  // has moved.
  enum class Moves { all, velocities, rest, nothing };
  // The form: of a linearization near the point.
  PointStatus project(MultibodyPoint& point, MultibodyEquations& equations, const MultibodyForm& form, Arena& arena,
                      Moves moves = Moves::all);
  // Moves all, for a point that is no end of a step; the data of later projections are unchanged.
  PointStatus project_output(MultibodyPoint& point, MultibodyEquations& equations, const MultibodyForm& form,
                             Arena& arena);
  // T and N of the last projected point; of an output T only if it was needed.
  const Tangents& tangents() const { return tangents_; }
  // For a point whose rows are measured; false if the partition does not fit it.
  bool build_tangents(const MultibodyPoint& point, const MultibodyForm& form, Arena& arena) {
    return form.build_tangents(point, tangents_, arena);
  }

  // Smallest pivot of C Q2 at the last projected point, and the violation of dependent constraints there.
  double smallest_pivot() const { return smallest_pivot_; }
  double inconsistency() const { return inconsistency_; }
  std::string inconsistency_message(const MultibodyProblem& problem, double t) const;

 private:
  bool approach(MultibodyPoint& point, MultibodyEquations& equations, const MultibodyForm& form, Arena& arena);
  PointStatus finish(MultibodyPoint& point, MultibodyEquations& equations, const MultibodyForm& form, Arena& arena,
                     Moves moves);
  PointStatus project_positions(MultibodyPoint& point, MultibodyEquations& equations, const MultibodyForm& form,
                                Arena& arena);
  PointStatus project_velocities(MultibodyPoint& point, MultibodyEquations& equations, const MultibodyForm& form,
                                 Arena& arena, bool has_approached);
  void measure_inconsistency(const MultibodyPoint& point, const MultibodyForm& form, Arena& arena);
  void compare(const Partition& partition, const double* residuals, const double* units, double size);

  Tangents tangents_;
  std::vector<double> inverse_weights_;
  double smallest_pivot_ = 1.0, inconsistency_ = 0.0;
  int inconsistent_row_ = -1;
};

}  // namespace sfdae::core
