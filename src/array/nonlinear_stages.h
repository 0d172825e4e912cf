// The stages of an implicit Runge-Kutta step for a nonlinear problem: simplified Newton with one linearization.
//
// Stage i has its own x_i, y_i; with dx_i = xp_i + T2 z_i the equations of all stages are
//
//     tau/h sum_j D_ij (g0_j + G z_j) - B z_i = b_i,   b_i = Z1^T (A xp_i - tau F(t_i, x_i, x_i'))
//     tau/h sum_j D_ij Uz^T z_j = -tau Uz^T T2^T x_i',   x_i' = sum_j D_ij (x_j - x) / h
//
// which transformed_stages.h decouples.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "array/analyzed_equations.h"
#include "array/array_linearization.h"
#include "array/jet_history.h"
#include "array/nonlinear_iteration.h"
#include "array/nonlinear_lanes.h"
#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "system/jet.h"

namespace sfdae::core {

class NonlinearStages {
 public:
  NonlinearStages(AnalyzedEquations& problem, Arena& arena) : problem_(problem), arena_(arena) {}

  // Predicts the starting jets. determined: flags of the components of y.
  void predict(const StageEquations& equations, const JetHistory& history, const std::vector<char>& determined);
  // Replaces their derivatives by those of the last accepted point.
  void hold_derivatives(const JetHistory& history) {
    for (int i = 0; i < s_; ++i) history.hold_derivatives(starts_[index(i)]);
  }
  // Iterates from these jets.
  PointStatus solve(const StageEquations& step, ArrayLinearization& linearization, NonlinearIteration& iteration);
  // The predicted jet at the middle of the step.
  const Jet& middle() const { return starts_[index(s_ / 2)]; }
  int count() const { return s_; }
  // A solved jet.
  const Jet& jet(int i) const { return jets_[index(i)]; }
  const Jet& last() const { return jets_[index(s_ - 1)]; }
  // x: n x s.
  void copy_to(double* x) const;

 private:
  class Equations;
  void resize(int s, const Jet& like);
  PointStatus evaluate(const StageEquations& equations, ArrayLinearization& linearization, double* rows);
  PointStatus evaluate_stage(const StageEquations& equations, int i, ArrayLinearization& linearization);
  void set_derivative(const StageEquations& equations, int i);
  void measure_derivative(const StageEquations& equations, RowSums kind, int i);
  double apply_changes(const IterationTask& task, const ArrayLinearization& linearization,
                       NonlinearIteration& iteration);

  View block(std::vector<double>& entries, int rows) const { return {entries.data(), rows, s_, rows > 0 ? rows : 1}; }
  ArrayResiduals residuals(int i) {
    const std::ptrdiff_t start = static_cast<std::ptrdiff_t>(i) * problem_.array_rows();
    return {f_.data() + start, transformed_.data() + start};
  }

  AnalyzedEquations& problem_;
  Arena& arena_;
  NonlinearLanes lanes_;
  int s_ = 0;
  std::vector<Jet> starts_, jets_, before_, sizes_;  // before_: the last change
  // A column for each stage.
  std::vector<double> f_, transformed_;  // ArrayResiduals
  std::vector<double> xp_, g0_;          // of the form
  std::vector<double> r_, z_;            // right-hand sides and solutions of the decoupled equations
  std::vector<double> xdot_;             // of one stage
};

}  // namespace sfdae::core
