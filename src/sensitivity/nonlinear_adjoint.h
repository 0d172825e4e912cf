// Adjoint sensitivities of a nonlinear problem, backward in time: the transposed equations of
// nonlinear_sensitivities.h.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "array/nonlinear_system.h"
#include "linalg/arena.h"
#include "problem/parameter_series.h"
#include "sensitivity/adjoint_point.h"
#include "sensitivity/sensitivity_stages.h"
#include "sensitivity/sparse_sensitivity_step.h"
#include "system/adjoint_system.h"

namespace sfdae::core {

class NonlinearAdjoint final : public AdjointSystem {
 public:
  // Arguments: as for NonlinearSensitivities.
  NonlinearAdjoint(NonlinearSystem& system, RecordedProblem& problem, std::vector<int> parameters);

  int unknowns() const override { return system_.unknowns(); }
  int count() const override { return parameters_.count(); }
  NonlinearSystem& system() override { return system_; }
  KeptPoint point(const double* xdot) const override;
  KeptPoint stage(const StageMethod& method, int i, const double* xdot) const override;
  std::unique_ptr<SystemTwin> twin() override;
  bool has_constraints() const override;
  PointStatus step_back(const KeptPoint& point, double c, const AdjointValues& values) override;
  PointStatus step_back(const StageMethod& method, double h, const KeptPoint* points,
                        const AdjointValues& values) override;
  PointStatus restore_back(const KeptPoint& point, const AdjointValues& values) override;
  void forget_work() override { work_.reset(); }
  PointStatus find_tangent_space(const KeptPoint& point, TangentSpace& space) override;
  const CallbackError& callback_error() const override { return callback_error_; }

 private:
  bool keeps_slopes() const { return parameters_.needs_slopes() || sparse_step_.is_possible(); }
  PointStatus linearize(AdjointPoint& at, const KeptPoint& point);
  PointStatus add_gradient(AdjointPoint& at, const KeptPoint& point, const AdjointPoint::Weights& weights,
                           View gradient);
  // Converts weights to those of scaled unknowns, n x any number, and back.
  View scaled(ConstView weights);
  void to_user(ConstView scaled, View weights) const;

  NonlinearSystem& system_;
  RecordedProblem& problem_;
  ParameterSeries parameters_;
  SparseSensitivityStep sparse_step_;
  // Memory for backward steps.
  struct Work {
    Arena arena;
    std::vector<AdjointPoint> points = std::vector<AdjointPoint>(index(max_stages));  // one for each stage
    SensitivityStages stages;
  };
  Work& work();
  std::unique_ptr<Work> work_;
  CallbackError callback_error_;
};

}  // namespace sfdae::core
