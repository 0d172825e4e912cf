// The stages of a step of a mechanical system side by side: the iteration of multibody_iteration.h, which takes them
// one by one, for systems whose formulas can be evaluated at several points at once. S is the identity, and there are
// no nonholonomic constraints, so that constraints of both levels have the same rows.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/lanes.h"
#include "multibody/multibody_equations.h"
#include "multibody/multibody_form.h"
#include "multibody/multibody_lane_kernels.h"
#include "multibody/multibody_lane_terms.h"
#include "multibody/multibody_stages.h"
#include "multibody/multibody_step_matrix.h"

namespace sfdae::core {

class MultibodyLanes {
 public:
  // Returns whether this is faster for so many stages; if so, allocates memory and finds the places of entries.
  bool prepare(int s, MultibodyEquations& equations, const MultibodyForm& form);

  // Starts from the initial guesses in the columns of qv. units: of the rows of constraints. The discretization must
  // stay unchanged.
  void begin(const MultibodyDiscretization& discretization, const MultibodyForm& form, const double* units,
             MultibodyStages& stages);
  // The residuals of the stages. False if one of them has to be evaluated alone.
  bool evaluate(MultibodyEquations& equations, const MultibodyForm& form);
  // Writes residuals to the stages' columns.
  void copy_residuals(MultibodyStages& stages) const;
  // Writes (q, v) and the last changes to their columns.
  void copy_values(MultibodyStages& stages) const;
  // Restores the columns to their former state.
  void leave(MultibodyStages& stages) const;
  // Changes all stages by the solution for these residuals; the norm of the change.
  using Norms = MultibodyLaneNorms;
  double change(const MultibodyForm& form, MultibodyStepMatrix& matrix, const Norms& norms, MultibodyStages& stages,
                Arena& arena);
  // Writes to the columns all results that are needed after the last change.
  void finish(const MultibodyForm& form, MultibodyStages& stages) const;

 private:
  void resize(int n, int r);
  void list_columns();
  MultibodyLaneWork work(const MultibodyForm& form) const;

  const MultibodyDiscretization* discretization_ = nullptr;
  int n_ = 0, rank_ = -1;
  bool is_usable_ = false, along_tangents_ = false;
  MultibodyLaneTerms terms_;
  MultibodyLaneRows rows_;
  // Pointers into memory_ and orders_.
  MultibodyLaneValues at_{};
  MultibodyLaneMatrices matrices_{};
  Lanes* D_ = nullptr;
  LaneArray memory_;
  std::vector<int> orders_;  // of rows, as factors have them
};

}  // namespace sfdae::core
