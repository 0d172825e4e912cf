// Kernels for the stages of a step of a mechanical system, side by side (multibody_lanes.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/index.h"
#include "linalg/lane_algebra.h"
#include "linalg/lanes.h"
#include "multibody/multibody_form.h"
#include "multibody/multibody_lane_terms.h"
#include "multibody/multibody_step_matrix.h"

namespace sfdae::core {

// Independent rows of C in their units, entry by entry, at the stages.
struct MultibodyLaneRows {
  std::vector<std::size_t> first,
      by_column;              // entries of C in column j: by_column[first[j]] to by_column[first[j + 1]]
  std::vector<int> position;  // of a row among the independent ones; -1: none of them
  std::vector<double> units;  // inverse ones of the independent rows
  Lanes* entries = nullptr;   // of C in these units
};

// Values at the stages, from the initial guesses to the changes.
struct MultibodyLaneValues {
  Lanes *t, *qv, *moves, *particular, *changes, *a, *mu, *residuals, *z;
  Lanes* sign;  // of det C Q2
};

// Matrices of the stages: factors of C Q2 and of C M^-1 C^T, T^T M T or K; T and M T; scratch memory.
struct MultibodyLaneMatrices {
  lane_algebra::Factors C2, reduced;
  Lanes *T, *MT, *scratch;
};

// Coupling of the stages: h, and D, column j in block j, row i in lane i.
struct MultibodyLaneMethod {
  int s;
  double h;
  const Lanes* D;
};

// Norms of changes, by components of (q, v).
struct MultibodyLaneNorms {
  const double* noise;
  const double* inverse_weights;
};

// Data of the kernels; n positions, n velocities, r independent constraints, d = n - r.
struct MultibodyLaneWork {
  int n, r, d;
  bool along_tangents, has_room_for_whole;
  const MultibodyForm& form;
  const MultibodyLaneTerms& terms;
  const MultibodyLaneRows& rows;
  MultibodyLaneMethod method;
  MultibodyLaneValues at;
  MultibodyLaneMatrices matrices;

  ConstView Q1() const { return form.positions().Q1(); }
  ConstView Q2() const { return form.positions().Q2(); }
  int row(int k) const { return form.positions().rows[index(k)]; }
  const std::vector<LaneMatrix::Place>& places() const { return terms.C.places; }
  template <class Action>
  void for_rows(Action action) const {
    const int* const position = rows.position.data();
    for (std::size_t e = 0; e < places().size(); ++e) {
      const int k = position[places()[e].row];
      if (k >= 0) action(k, places()[e].column, rows.entries[e]);
    }
  }
};

// Computes a, mu, particular changes, residuals and signs from the terms. False: not all points can be evaluated here.
bool evaluate_stages(const MultibodyLaneWork& work);
// Computes the changes and their norm from the residuals, or from z if `inverses` is null; NaN if one is not finite.
double change_stages(const MultibodyLaneWork& work, const MultibodyStepMatrix::LaneInverses* inverses,
                     const MultibodyLaneNorms& norms);

}  // namespace sfdae::core
