// The discrete adjoint of an integration: its steps are kept, and the equations of their sensitivities read backward.
//
// S_k = dx(t_k)/dp at the points of an integration follows from earlier ones by the linear equations that sensitivities.h solves.
// For a functional with weights w_k of x(t_k) the gradient sum_k S_k^T w_k is found in one pass from the last point to the
// first: lambda_k = w_k + what later steps make of S_k. What is found is the exact gradient of what the integration has computed,
// hidden constraints included, but for the choice of its steps.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "integrate/companion.h"
#include "integrate/step_control.h"
#include "linalg/matrix.h"
#include "system/adjoint_system.h"

namespace sfdae::core {

class DiscreteAdjoint final : public Companion {
 public:
  // S: at the point where the system of x stands, consistent, n x count.
  DiscreteAdjoint(std::unique_ptr<AdjointSystem> system, std::vector<double> S);

  void start(const Integrator& integrator) override;
  StepOutcome attempt(Integrator& integrator, const Tolerances& tolerances) override;
  void commit(Integrator& integrator) override;

  // The last point with that time: the start, or the end of a step.
  std::optional<std::size_t> point_at(double t) const;
  // The time nearest to t that there is such a point at.
  double nearest_time(double t) const;

  // weights: n x points.size() for each functional, one after the other; gradient: count x functionals. move_to(t): the
  // equations are those of a step from t. Throws Failure.
  struct Functionals {
    const std::vector<std::size_t>& points;
    const double* weights;
    int count;
  };
  void gradient(const Functionals& functionals, const std::function<void(double)>& move_to, double* gradient);

  int count() const { return system_->count(); }
  int unknowns() const { return system_->unknowns(); }
  long steps() const { return static_cast<long>(steps_.size()) - 1; }
  // Of what is kept.
  std::size_t bytes() const { return bytes_; }

 private:
  // What leads to a point from those before.
  struct Step {
    double t = 0.0, h = 0.0;  // its end; its size
    int order = 0;            // of BDF; 0: none, or Radau
    double c = 0.0;           // D_h S = c S + sum_i rest_i S_i, the newest point before first
    std::array<double, max_bdf_order> rest{};
    const StageMethod* method = nullptr;  // of Radau
    std::size_t first_kept = 0;
  };
  Step step_to(const TriedStep& tried) const;
  void make_room();
  void read_back(std::size_t k, std::vector<Matrix>& weights, View gradient);

  std::unique_ptr<AdjointSystem> system_;
  std::vector<double> S_;
  std::vector<Step> steps_;  // the first leads nowhere; one of order 0 without method restores S
  std::vector<KeptPoint> kept_;
  std::size_t origin_ = 0;  // the point at which the history of BDF starts
  std::size_t bytes_ = 0;
  Step tried_;
  std::vector<KeptPoint> tried_points_;
  std::vector<double> xdot_;
};

}  // namespace sfdae::core
