// Points within steps that are kept, for the adjoint: what leads there from the ends of steps.
//
// With BDF the polynomial through the newest points, made consistent; with Radau a shorter step from where the step
// began. S at points within steps is found in the same way forward (sensitivities.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "integrate/error_weights.h"
#include "integrate/hermite_table.h"
#include "integrate/kept_steps.h"
#include "system/adjoint_system.h"

namespace sfdae::core {

// A step that was kept, with the points that it depends on, the newest first: enough for its formula.
struct KeptSurroundings {
  const KeptStep& step;
  const KeptPoint* own;                  // its end, or its stages
  std::vector<const KeptPoint*> before;  // the first one is its start
  const double* newest;                  // the time of its end, those of earlier points in front of it
};

// Of Radau: the stages of a step.
struct ShorterStep {
  double h;
  std::vector<KeptPoint> stages;
};

class PointsWithin {
 public:
  // keep_to_piece: evaluations of a system are those of a step from t.
  using KeepToPiece = std::function<void(DaeSystem&, double t)>;
  PointsWithin(AdjointSystem& system, const Tolerances& tolerances, KeepToPiece keep_to_piece);

  // Of BDF: x at t, by the formula of interpolation_at(). Throws Failure.
  KeptPoint interpolated(const KeptSurroundings& given, const KeptStep& formula);
  // Of Radau: the step to t, or a few that follow one another where it has no solution. Throws Failure.
  std::vector<ShorterStep> steps_to(double t, const KeptSurroundings& given);

 private:
  void stand_at(const KeptSurroundings& given);
  Guess predict(const StageMethod& method, double t_start, double t_end, const KeptSurroundings& given);

  AdjointSystem& system_;
  std::unique_ptr<SystemTwin> twin_;  // between these points
  double from_ = 0.0, to_ = 0.0;
  ErrorWeights weights_;
  KeepToPiece keep_to_piece_;
  HermiteTable collocation_;
  std::vector<double> stages_, w_, xdot_, predicted_, at_end_, at_start_;
};

}  // namespace sfdae::core
