// A linear problem with its system.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "linear/linear_change_watch.h"
#include "linear/linear_system.h"
#include "problem/linear_problem.h"
#include "problem/recorded_linear.h"
#include "reduction/derivative_array.h"
#include "system/model.h"

namespace sfdae::core {

class LinearModel final : public ModelOf<LinearSystem> {
 public:
  explicit LinearModel(const LinearFunctions& functions) : problem_(functions) {}
  // Recorded equations that are linear: E, A and f are read off the record.
  explicit LinearModel(std::unique_ptr<RecordedLinearCoefficients> coefficients);

  // A second model of the same recorded equations; null for functions.
  std::unique_ptr<LinearModel> clone() const {
    return recorded_ ? std::make_unique<LinearModel>(recorded_->clone()) : nullptr;
  }

  LinearProblem& problem() override { return problem_; }
  int m() const override { return problem_.m(); }
  int n() const override { return problem_.n(); }
  bool is_constant() const override { return problem_.is_constant(); }
  bool needs_x() const override { return false; }
  EvaluationCounts evaluations() const override;
  TaylorEvaluator* evaluator() override { return recorded_ ? &recorded_->evaluator() : nullptr; }
  void parameters_changed() override;
  void add_equations(WordHash& hash) override {
    Model::add_equations(hash);
    hash.add_all(problem_.prescribed());
  }
  void analyze(const PointOfInterest& point, const ModelOptions& options,
               std::vector<RankDecision>& decisions) override;
  void demand_derivatives(const PointOfInterest& point, const ModelOptions& options) override;
  void undo_restore() override;
  double certify() override;
  std::unique_ptr<ChangeWatch> change_watch() override { return std::make_unique<LinearChangeWatch>(*system_); }

  // Moves the system to t. Throws Failure if the characteristic values do not hold, or if redundant equations
  // contradict each other and that is not to be ignored; true if it is.
  bool set_point(double t, const ModelOptions& options) { return set_point(*system_, t, options); }

  Jump jump(const PointOfInterest& point, const ModelOptions& options) override;

  // Equations linearized anywhere are those of x = 0. Both throw Failure.
  DerivativeArray derivative_array(double t, int level);
  Projectors projectors(double t);
  Jet jet_through(double t, const double* x, int level) override;
  DerivativeArray derivative_array(const Jet& jet, int level) override;
  Projectors projectors(const Jet& jet, bool) override { return projectors(jet.t); }
  StrangenessFreeEquations strangeness_free(const Jet& jet) override;

 protected:
  std::unique_ptr<LinearSystem> copy_of_system() override;
  std::unique_ptr<LinearSystem> archived_system(const ModelOptions& options, Archive& archive) override;
  ConsistentPoint make_consistent(LinearSystem& system, const PointOfInterest& point,
                                  const ModelOptions& options) override;

 private:
  static bool set_point(LinearSystem& system, double t, const ModelOptions& options);

  std::unique_ptr<RecordedLinearCoefficients> recorded_;  // problem_ calls it
  LinearProblem problem_;
  LinearProblem::Settings settings_before_;  // restore()
};

}  // namespace sfdae::core
