// What is computed for the stages of a step of a mechanical system side by side (multibody_lanes.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/lane_algebra.h"
#include "linalg/lanes.h"
#include "multibody/multibody_form.h"
#include "multibody/multibody_lane_terms.h"
#include "multibody/multibody_step_matrix.h"

namespace sfdae::core {

// All that the kernels work on; n positions, n velocities, r independent constraints, d = n - r.
struct MultibodyLaneWork {
  int n, r, d, s;
  const MultibodyForm& form;
  const MultibodyLaneTerms& terms;
  bool along_tangents, has_room_for_whole;
  // Entries of C in column j: by_column[first[j]] to by_column[first[j + 1]].
  const std::size_t *first, *by_column;
  const int* position_of_row;  // among the independent ones; -1: none of them
  const double* units;         // inverse ones of the independent rows
  Lanes* rows;                 // entries of C in these units
  lane_algebra::Factors C2, reduced;
  Lanes *T, *MT, *scratch;
  Lanes *qv, *moves, *particular, *changes, *a, *mu, *residuals;
  Lanes* z;
  const Lanes* D;
  double h;
  const MultibodyStepMatrix::LaneInverses* inverses = nullptr;  // null: z is known
  const double* noise = nullptr;
  const double* inverse_weights = nullptr;
  // Results: whether all points could be evaluated here, signs of det C Q2, the norm of the change.
  bool is_good = true;
  Lanes sign{};
  double norm = 0.0;

  ConstView Q1() const { return form.positions().Q1(); }
  ConstView Q2() const { return form.positions().Q2(); }
  int row(int k) const { return form.positions().rows[index(k)]; }
  const std::vector<LaneMatrix::Place>& places() const { return terms.C.places; }
  template <class Action>
  void for_rows(Action action) const {
    for (std::size_t e = 0; e < places().size(); ++e) {
      const int k = position_of_row[places()[e].row];
      if (k >= 0) action(k, places()[e].column, rows[e]);
    }
  }
};

// From the terms: a, mu, particular changes and residuals, unless is_good becomes false.
void evaluate_stages(MultibodyLaneWork& work);
// From the residuals, or z: the changes and their norm, NaN if one of them is not finite.
void change_stages(MultibodyLaneWork& work);

}  // namespace sfdae::core
