// The stages of a Radau step of sensitivities linearized side by side, one in each lane: tangents T2 and xp by the
// minimal extension, and Z1^T (E, A, f), as SensitivityPoint computes them one by one (docs/design/sensitivities.md).
//
// Z1 is the orthonormal basis of the range of E T2, rows scaled, by the modified Gram-Schmidt method [B67]. Only the
// range matters, and it is accurate to machine precision.
//
// [B67] A. Bjoerck: Solving linear least squares problems by Gram-Schmidt orthogonalization. BIT 7 (1967), 1-21.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "array/analyzed_equations.h"
#include "linalg/lanes.h"
#include "linalg/planned_lanes.h"
#include "problem/parameter_series.h"
#include "sensitivity/extended_sensitivity_step.h"
#include "sensitivity/sensitivity_stages.h"
#include "sensitivity/sparse_sensitivity_step.h"
#include "system/jet.h"

namespace sfdae::core {

class ExtendedStageLanes {
 public:
  // All arguments must outlive this object.
  ExtendedStageLanes(RecordedProblem& problem, ParameterSeries& parameters, ExtendedSensitivityStep& extension)
      : problem_(problem), parameters_(parameters), extension_(extension) {}

  // Returns whether s stages can be stored here, numbered 0, ..., s - 1 and in this order.
  bool begin(int s);
  // xdot: x' there, or null: that of the jet.
  void keep(int i, const Jet& jet, const double* xdot);
  // Linearizes all stages into `stages`, which has their sizes. False: they have to be linearized one by one.
  bool linearize(const AnalyzedEquations& equations, SensitivityStages& stages);
  // The stored jet of a stage.
  Jet jet(int i) const;
  const double* xdot(int i, std::vector<double>& buffer) const;

 private:
  void resize();
  bool find_tangents();
  bool find_row_factors(const AnalyzedEquations& equations);
  void write(const AnalyzedEquations& equations, SensitivityStages& stages) const;

  RecordedProblem& problem_;
  ParameterSeries& parameters_;
  ExtendedSensitivityStep& extension_;
  int s_ = 0, n_ = 0, jet_order_ = 0;
  std::vector<RecordedEntry> entries_;
  std::vector<int> level_0_;  // limits of entries of level 0
  // Stored data; jets: n x (order + 1).
  struct Points {
    LaneArray t, jets, x_xdot;
    bool has_slopes = false;
  } points_;
  LaneArray matrix_, right_, tangents_;  // of the extension; columns: xp, then T2
  LaneArray row_sizes_, row_factors_;
  LaneArray Z1_;  // m x d, by rows
  // Z1^T E and Z1^T A, n x d by rows; columns of d.
  struct Projected {
    LaneArray ZE, ZA, B, Zf;
  } projected_;
  PlannedLanes planned_;
  std::vector<double> factors_;
};

}  // namespace sfdae::core
