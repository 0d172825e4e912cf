// The stages of a Radau step of recorded equations side by side: like NonlinearStages, one stage per lane. If that is
// not possible, NonlinearStages continues from the last iterate, one stage after the other.
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
  // True if stages of these equations can be solved here; allocates memory for them.
  bool prepare(const StageEquations& step, const AnalyzedEquations& problem, const ArrayLinearization& linearization);
  // Starts from these jets.
  void begin(const StageEquations& step, const AnalyzedEquations& problem, const ArrayLinearization& linearization,
             const std::vector<Jet>& jets);
  // Evaluates the residuals of all stages and the step equations; false if that is not possible here.
  bool evaluate(AnalyzedEquations& problem, const ArrayLinearization& linearization);
  // Copies rows of these residuals, like ArrayLinearization::copy_step_rows for one stage after the other.
  void copy_rows(const ArrayLinearization& linearization, double* rows) const;
  // Changes the jets; returns the norm of the change, NaN if it is not finite.
  double change(ArrayLinearization& linearization, Arena& arena);
  // Copies the last iterate and the one before it.
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
