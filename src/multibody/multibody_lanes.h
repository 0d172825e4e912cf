// The stages of a step of a mechanical system side by side: what multibody_iteration.h does with one after the other,
// for systems whose formulas can be evaluated at several points at once. S is the identity, and there are no
// nonholonomic constraints, so that constraints of both levels have the same rows.
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
  // Whether this is the faster way for so many stages; memory then, and the places of entries.
  bool prepare(int s, MultibodyEquations& equations, const MultibodyForm& form);

  // From the guesses in the columns of qv. units: of the rows of constraints. The discretization has to stay.
  void begin(const MultibodyDiscretization& discretization, const MultibodyForm& form, const double* units,
             MultibodyStages& stages);
  // The residuals of the stages. False where one of them has to be looked at alone.
  bool evaluate(MultibodyEquations& equations, const MultibodyForm& form);
  // To their columns.
  void copy_residuals(MultibodyStages& stages) const;
  // (q, v) and the last changes, to their columns.
  void copy_values(MultibodyStages& stages) const;
  // Back to the columns, as they were before that.
  void leave(MultibodyStages& stages) const;
  // Changes all stages by the solution for these residuals; the norm of the change.
  using Norms = MultibodyLaneNorms;
  double change(const MultibodyForm& form, MultibodyStepMatrix& matrix, const Norms& norms, MultibodyStages& stages,
                Arena& arena);
  // Puts into the columns what is asked for after the last change.
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
  // Into memory_ and orders_.
  MultibodyLaneValues at_{};
  MultibodyLaneMatrices matrices_{};
  Lanes* D_ = nullptr;
  LaneArray memory_;
  std::vector<int> orders_;  // of rows, as factors have them
};

}  // namespace sfdae::core
