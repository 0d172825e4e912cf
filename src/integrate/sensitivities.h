// Sensitivities computed along with the steps of x: by the same formulas, after each step of x [FTB97].
//
// [FTB97] W. F. Feehery, J. E. Tolsma, P. I. Barton: Efficient sensitivity analysis of large-scale
// differential-algebraic
//         systems. Appl. Numer. Math. 25 (1997).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "integrate/bdf_error_estimate.h"
#include "integrate/bdf_history.h"
#include "integrate/bdf_step.h"
#include "integrate/companion.h"
#include "integrate/error_weights.h"
#include "integrate/sensitivity_error_estimate.h"
#include "system/sensitivity_system.h"
#include "system/tolerances.h"

namespace sfdae::core {

struct SensitivityOptions {
  bool error_test = false;     // of S and x, otherwise of x only
  std::vector<double> scales;  // of the parameters: the tolerances of x_i apply to S_ij scale_j
  bool operator==(const SensitivityOptions&) const = default;
};

struct SensitivityWork {
  long linearizations = 0, factorizations = 0, error_failures = 0, outputs = 0;
  double inconsistency = 0.0;  // largest contradiction of redundant equations
};

class Sensitivities final : public Companion {
 public:
  // S: at the current point of the system of x, consistent; arbitrary if archive() will read them.
  Sensitivities(std::unique_ptr<SensitivitySystem> system, SensitivityOptions options, std::vector<double> S);
  // Reading replaces start(), after the integrator was restored. Throws DamagedArchive.
  void archive(Archive& archive, const Integrator& integrator);

  void start(const Integrator& integrator) override;
  // Includes the error test of S if requested; error_too_large: the next step is smaller.
  StepOutcome attempt(Integrator& integrator, const Tolerances& tolerances) override;
  void commit(Integrator& integrator) override;

  // S at the last point, as computed by the step.
  void copy_last(double* S);
  const std::vector<double>& last() const { return S_; }
  ConstView columns() const { return {S_.data(), unknowns(), count(), unknowns()}; }
  // After jumps of x, or a moved time; start() must follow.
  void replace_last(std::vector<double> S) { S_ = std::move(S); }
  // Points within the last step, to which the system of x has been moved: by the polynomial of BDF, ...
  void evaluate(const Integrator& integrator, double t, double* S, double* Sdot);
  // ... or the stages of a shorter Radau step to t: move(stage time), which returns x', is called for all of them; the
  // last is t.
  template <class Move>
  void evaluate_by_stages(const Integrator& integrator, double t, Move move, double* S, double* Sdot);
  // True if evaluate_by_stages() is required.
  bool needs_stages(const Integrator& integrator, double t) const;

  void parameters_changed() { system_->parameters_changed(); }

  const std::vector<int>& parameters() const { return system_->parameters(); }
  int count() const { return system_->count(); }
  int unknowns() const { return system_->unknowns(); }
  std::size_t size() const { return system_->size(); }
  SensitivityWork work() const;

 private:
  void demand(PointStatus status, double t) const;
  StepOutcome solve_tried();
  void set_weights(const Tolerances& tolerances, Tightening tightening);
  StepOutcome test_error(Integrator& integrator, const Tolerances& tolerances);
  StepOutcome test_error_of_bdf(Integrator& integrator);
  StepOutcome test_error_of_radau(Integrator& integrator);
  PointStatus solve_bdf(const TriedStep& tried);
  PointStatus solve_radau(const TriedStep& tried);
  void archive_history(Archive& archive, const Integrator& integrator);
  void finish_stages(double t, double h, double* S, double* Sdot);

  std::unique_ptr<SensitivitySystem> system_;
  SensitivityOptions options_;
  SensitivityWork work_;
  std::vector<double> S_, Sdot_;  // at the last point; the slope only at starts
  std::vector<double> before_;    // S at the start of the last step
  TriedStep step_tried_;
  std::vector<double> tried_;  // at its end
  BdfHistory history_;
  BdfStep step_;
  const StageMethod* method_ = nullptr;  // of the last step, for Radau
  std::vector<double> stages_, slopes_, error_;
  std::vector<double> xdot_;
  SensitivityErrorEstimate estimate_;  // for Radau
  BdfErrorEstimate estimate_of_bdf_;
  std::vector<ErrorWeights> weights_;
  Tolerances tolerances_;  // from which the weights were computed
  Tightening tightening_ = Tightening::none;
};

template <class Move>
void Sensitivities::evaluate_by_stages(const Integrator& integrator, double t, Move move, double* S, double* Sdot) {
  const StepState state = integrator.stepper->state();
  const double from = state.t - state.last.h, h = t - from;
  const StageMethod& method = *method_;
  for (int i = 0; i < method.s; ++i) {
    const double* const xdot = move(i + 1 == method.s ? t : from + method.c[index(i)] * h);
    demand(system_->keep_stage(method, i, xdot), t);
  }
  finish_stages(t, h, S, Sdot);
}

}  // namespace sfdae::core
