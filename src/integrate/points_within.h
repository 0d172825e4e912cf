// Points within stored steps, for the adjoint.
//
// BDF: the polynomial through the newest points, made consistent; Radau: a shorter step from the start of the step. The
// forward sensitivities at points within steps are computed in the same way (sensitivities.h).
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

// A stored step with the points of its formula, the newest first.
struct KeptSurroundings {
  const KeptStep& step;
  const KeptPoint* own;                  // its end, or its stages
  std::vector<const KeptPoint*> before;  // the first one is its start
  const double* newest;                  // time of its end, preceded in memory by those of earlier points
};

// A shorter step of Radau with its stages.
struct ShorterStep {
  double h;
  std::vector<KeptPoint> stages;
};

class PointsWithin {
 public:
  // keep_to_piece: restricts evaluations of a system to those of a step from t.
  using KeepToPiece = std::function<void(DaeSystem&, double t)>;
  PointsWithin(AdjointSystem& system, const Tolerances& tolerances, KeepToPiece keep_to_piece);

  // BDF: x at t, by the formula of interpolation_at(). Throws Failure.
  KeptPoint interpolated(const KeptSurroundings& given, const KeptStep& formula);
  // Radau: the step to t, or several consecutive ones if it has no solution. Throws Failure.
  std::vector<ShorterStep> steps_to(double t, const KeptSurroundings& given);

 private:
  void stand_at(const KeptSurroundings& given);
  Guess predict(const StageMethod& method, double t_start, double t_end, const KeptSurroundings& given);

  AdjointSystem& system_;
  std::unique_ptr<SystemTwin> twin_;  // at these points
  double from_ = 0.0, to_ = 0.0;
  ErrorWeights weights_;
  KeepToPiece keep_to_piece_;
  HermiteTable collocation_;
  std::vector<double> stages_, w_, xdot_, predicted_, at_end_, at_start_;
};

}  // namespace sfdae::core
