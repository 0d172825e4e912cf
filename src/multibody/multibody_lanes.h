// The stages of a step of a mechanical system side by side: what multibody_iteration.h does with one after the other,
// for systems whose formulas can be evaluated at several points at once. S is the identity, and there are no
// nonholonomic constraints, so that constraints of both levels have the same rows.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/lanes.h"
#include "multibody/multibody_equations.h"
#include "multibody/multibody_form.h"
#include "multibody/multibody_lane_terms.h"
#include "multibody/multibody_stages.h"
#include "multibody/multibody_step_matrix.h"

namespace sfdae::core {

struct MultibodyLaneWork;

class MultibodyLanes {
 public:
  // Whether this is the faster way for so many stages; memory then, and the places of entries.
  bool prepare(int s, MultibodyEquations& equations, const MultibodyForm& form);

  // From the guesses in the columns of qv. units: of the rows of constraints. The discretization has to stay.
  void begin(const MultibodyDiscretization& discretization, const MultibodyForm& form, const double* units,
             MultibodyStages& stages);
  // The residuals of the stages. False where one of them has to be looked at alone.
  bool evaluate(MultibodyEquations& equations, const MultibodyForm& form);
  // Back to the columns, as they were before that.
  void leave(MultibodyStages& stages) const;
  // Changes all stages by the solution for these residuals; the norm of the change. Norms: by components of (q, v).
  struct Norms {
    const double* noise;
    const double* inverse_weights;
  };
  double change(const MultibodyForm& form, MultibodyStepMatrix& matrix, const Norms& norms, MultibodyStages& stages,
                Arena& arena);
  // Puts into the columns what is asked for after the last change.
  void finish(const MultibodyForm& form, MultibodyStages& stages) const;

 private:
  void resize(int n, int r);
  MultibodyLaneWork work(const MultibodyForm& form);

  const MultibodyDiscretization* discretization_ = nullptr;
  int n_ = 0, rank_ = -1;
  bool is_usable_ = false, along_tangents_ = false;
  MultibodyLaneTerms terms_;
  std::vector<std::size_t> first_of_column_, by_column_;  // of the entries of C
  std::vector<int> position_of_row_;
  std::vector<double> units_;  // inverse ones of the independent rows
  LaneArray t_, qv_, moves_, particular_, changes_, a_, mu_, r_, z_;
  LaneBlock sign_;
  LaneArray D_;                          // of the method: columns, row i in lane i
  LaneArray rows_;                       // of C, in their units, by the entries of C
  LaneArray lu_, inverse_;               // of C Q2
  LaneArray reduced_, reduced_inverse_;  // C M^-1 C^T, T^T M T or K
  LaneArray T_, MT_, scratch_;
  std::vector<int> order_, reduced_order_;
};

}  // namespace sfdae::core
