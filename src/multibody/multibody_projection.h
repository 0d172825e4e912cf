// Points near by where the constraints of a mechanical system hold on both levels.
//
// Only the dependent directions of the partition move: Q_q2 until g = 0 to rounding, then Q_v2 until C v + r = 0.
// Accelerations and forces are those of the point found.
//
// Outputs are many: Newton's method on both levels at once brings them so near that terms need be evaluated once
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
  // Of (q, v): an error of one unit is as large as the tolerance. 0, before there are any, for no tolerance.
  void set_weights(const double* inverse_weights);

  // What is to move; positions that stay are those of a point with terms and rows. rest: velocities, which approach()
  // has moved.
  enum class Moves { all, velocities, rest, nothing };
  // The form: of a linearization near the point.
  PointStatus project(MultibodyPoint& point, MultibodyEquations& equations, const MultibodyForm& form, Arena& arena,
                      Moves moves = Moves::all);
  // All moves, for a point that is no end of a step; what later ones depend on is left as it is.
  PointStatus project_output(MultibodyPoint& point, MultibodyEquations& equations, const MultibodyForm& form,
                             Arena& arena);
  // T and N of the point projected last, T where it was needed if that is an output.
  const Tangents& tangents() const { return tangents_; }
  // At a point whose rows are measured; false if the partition does not fit it.
  bool build_tangents(const MultibodyPoint& point, const MultibodyForm& form, Arena& arena) {
    return form.build_tangents(point, tangents_, arena);
  }

  // Of the point projected last: the smallest pivot of C Q2, and by how much dependent constraints are violated.
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
