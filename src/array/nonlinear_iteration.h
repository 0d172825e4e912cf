// The chord iteration for the nonlinear equations at one point, with a linearization from elsewhere.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "array/analyzed_equations.h"
#include "array/array_linearization.h"
#include "array/residual_map.h"
#include "linalg/arena.h"
#include "system/anderson_mixing.h"
#include "system/chord_iteration.h"
#include "system/jet.h"

namespace sfdae::core {

// Equations to be solved besides the constraints, and the accuracy.
struct IterationTask {
  bool has_step = false;  // Z1^T F(t, x, c x + w_rest) = 0, else dx keeps Z1^T E x
  double c = 0.0;
  const double* w_rest = nullptr;
  const double* x_rest = nullptr;
  const double* inverse_weights = nullptr;  // with a step; else null: to machine precision
  double tolerance = 0.0;                   // of the weighted changes of x
  bool is_mixed = false;                    // Anderson mixing: faster, converges from farther away
  const ResidualMap* map = nullptr;         // without a step: that of the linearization, or null
  double stagnant = 1e-13;  // without a step: relative changes that are roundoff if they stay as they are
};

// Limit of weighted changes, in units of the tolerances of a step: errors of the iteration must not affect error
// estimates. Chosen, not measured.
inline constexpr double newton_tolerance = 0.01;

// The values of an iteration before and after its last change.
struct StepValues {
  const Jet &now, &before;
  double c;
  const double* inverse_weights;
};
// Sizes of the terms of a step, column by column. Tolerances of derivatives reflect their effect over the step.
void take_sizes(RowSums kind, const StepValues& values, Jet& sizes);

class NonlinearIteration {
 public:
  NonlinearIteration(const AnalyzedEquations& problem, Arena& arena) : problem_(problem), arena_(arena) {}
  // Memory for the values that the analysis has found.
  void resize();

  // Iterates from the jet to the one that solves the task.
  PointStatus solve(const IterationTask& task, ArrayLinearization& linearization, Jet& jet);
  // Solves without a step to machine precision. The rate flag stays as it was, as later points depend on it.
  PointStatus solve_to_rounding(ArrayLinearization& linearization, Jet& jet, const ResidualMap* map = nullptr);
  // Like solve_to_rounding() without a better linearization: larger changes may be roundoff, as of exp(x) - 1.
  PointStatus solve_at_last(ArrayLinearization& linearization, Jet& jet);
  // One change without a step: its relative size, and the largest residual before it.
  struct Improvement {
    double change = 0.0, residual = 0.0;
  };
  // Makes one such change of the jet.
  PointStatus improve(ArrayLinearization& linearization, Jet& jet, Improvement& made);
  // Checks redundant equations at a jet that has converged otherwise. Known ranks that do not fit the jet of the
  // linearization leave out equations that are not redundant, which then contradict the others.
  PointStatus check_redundant(const IterationTask& task, ArrayLinearization& linearization, const Jet& jet);

  // Relative contradiction of redundant equations at the last solved point.
  double inconsistency() const { return inconsistency_; }
  bool has_contradiction() const;
  ChordIteration& chord() { return chord_; }

  // Changes the jet by dx and the corresponding dy. Returns the norm of the change, relative to x without weights.
  double apply_change(const IterationTask& task, const ArrayLinearization& linearization,
                      const ArrayResiduals& residuals, const double* dx, Jet& jet);

 private:
  class StepEquations;
  PointStatus solve_step(const IterationTask& task, ArrayLinearization& linearization, Jet& jet);
  PointStatus solve_without_step(const IterationTask& task, ArrayLinearization& linearization, Jet& jet);
  PointStatus solve_to_rounding(const IterationTask& task, ArrayLinearization& linearization, Jet& jet);
  static bool is_rounding_error(const IterationTask& task, int iteration, double norm, double before);
  ArrayResiduals residuals() { return {array_f_.data(), transformed_f_.data()}; }
  PointStatus evaluate(const IterationTask& task, ArrayLinearization& linearization, const Jet& jet);
  void solve_linearized(ArrayLinearization& linearization, const Jet& jet);
  double apply_map(const IterationTask& task, const ArrayLinearization& linearization, Jet& jet);
  void mix(const ArrayLinearization& linearization, Jet& jet);
  double relative_norm(const ArrayLinearization& linearization, const double* dx, const Jet& jet) const;
  double weighted_norm(const IterationTask& task, const ArrayLinearization& linearization, const double* dx) const;
  bool derivatives_follow(const TaylorData& data, const Jet& jet, double residual, double largest) const;
  void measure_inconsistency(const IterationTask& task, ArrayLinearization& linearization, const Jet& jet);

  const AnalyzedEquations& problem_;
  Arena& arena_;
  ChordIteration chord_;
  double inconsistency_ = 0.0;
  std::vector<double> array_f_, transformed_f_;
  std::vector<double> dx_, dy_, z_, xdot_;
  AndersonMixing mixing_;
  std::vector<double> change_, correction_;  // of x and y
  Jet refined_;
  Jet before_, sizes_;  // before the last change of a step
};

}  // namespace sfdae::core
