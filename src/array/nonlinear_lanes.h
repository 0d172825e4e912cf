// The stages of a Radau step of recorded equations side by side: what NonlinearStages does, one stage to a lane.
// Where that cannot be done, for whatever reason, the stages are looked at one by one from where the iteration stands.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "array/analyzed_equations.h"
#include "array/array_linearization.h"
#include "array/nonlinear_lane_kernels.h"
#include "linalg/arena.h"
#include "linalg/lanes.h"
#include "system/jet.h"

namespace sfdae::core {

class NonlinearLanes {
 public:
  // Whether stages of these equations can be solved here, and memory for them.
  bool prepare(const StageEquations& step, const AnalyzedEquations& problem, const ArrayLinearization& linearization);
  // From these jets on.
  void begin(const StageEquations& step, const AnalyzedEquations& problem, const ArrayLinearization& linearization,
             const std::vector<Jet>& jets);
  // Residuals at all stages, and what the step equations become by them; false: not here.
  bool evaluate(AnalyzedEquations& problem, const ArrayLinearization& linearization);
  // Copies rows of these residuals, as ArrayLinearization::copy_step_rows for one stage after the other.
  void copy_rows(const ArrayLinearization& linearization, double* rows) const;
  // The jets change; returns the norm of the change, NaN if it is not finite.
  double change(ArrayLinearization& linearization, Arena& arena);
  // As far as the iteration has come, and before its last change.
  void leave(std::vector<Jet>& jets, std::vector<Jet>& before) const;

 private:
  void resize(int m, int n, int mu);
  NonlinearLaneWork work(const ArrayLinearization& linearization);

  const StageEquations* step_ = nullptr;
  int m_ = 0, n_ = 0, mu_ = -1;
  LaneArray t_, D_, jets_, before_, x_xdot_, f_, f_step_, transformed_, r_, z_, changes_, scratch_;
  std::vector<double> norms_, factors_;
  std::vector<double> r_columns_, z_columns_;  // of the decoupled equations, a column for each stage
};

}  // namespace sfdae::core
