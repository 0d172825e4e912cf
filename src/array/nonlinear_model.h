// A nonlinear problem with its system.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "array/nonlinear_change_watch.h"
#include "array/nonlinear_system.h"
#include "problem/callback_problem.h"
#include "problem/nonlinear_problem.h"
#include "starts/jump_derivatives.h"
#include "system/model.h"

namespace sfdae::core {

class NonlinearModel final : public ModelOf<NonlinearSystem> {
 public:
  explicit NonlinearModel(std::unique_ptr<RecordedProblem> problem)
      : recorded_(problem.get()), problem_(std::move(problem)) {}
  explicit NonlinearModel(std::unique_ptr<CallbackProblem> problem)
      : callback_(problem.get()), problem_(std::move(problem)) {}

  // A copy with the same recorded equations; null for callbacks.
  std::unique_ptr<NonlinearModel> clone() const {
    return recorded_ != nullptr ? std::make_unique<NonlinearModel>(std::make_unique<RecordedProblem>(*recorded_))
                                : nullptr;
  }

  NonlinearProblem& problem() override { return *problem_; }
  RecordedProblem* recorded() { return recorded_; }  // null for callbacks
  int m() const override { return problem_->m(); }
  int n() const override { return problem_->n(); }
  bool is_constant() const override { return false; }
  bool needs_x() const override { return true; }
  EvaluationCounts evaluations() const override {
    return {.F = problem_->evaluations(), .linearizations = problem_->linearizations()};
  }
  TaylorEvaluator* evaluator() override { return recorded_ != nullptr ? &recorded_->evaluator() : nullptr; }
  void add_equations(WordHash& hash) override {
    Model::add_equations(hash);
    hash.add_all(problem_->prescribed());
    if (problem_->counts_are_given()) hash.add_all(problem_->differentiations());
  }
  void analyze(const PointOfInterest& point, const ModelOptions& options,
               std::vector<RankDecision>& decisions) override;
  void demand_derivatives(const PointOfInterest& point, const ModelOptions& options) override;
  void demand_derivatives_along(const Jet& jet, const PointOfInterest& point, const ModelOptions& options) override;
  void undo_restore() override;
  double certify() override;
  std::unique_ptr<ChangeWatch> change_watch() override { return std::make_unique<NonlinearChangeWatch>(*system_); }
  std::unique_ptr<SensitivitySystem> sensitivities(std::vector<int> parameters) override;
  bool follows_structure() const { return problem_->follows_structure(); }
  // The user's callback for total derivatives; null for recorded equations.
  CallbackProblem* callback() { return callback_; }

  Jump jump(const PointOfInterest& point, const ModelOptions& options) override;
  bool differentiate_jump(const MovingJump& moving, const ModelOptions& options, View after) override;

  bool fulfils_equations(const PointOfInterest& point) override;
  Jet jet_through(double t, const double* x, int level) override;
  DerivativeArray derivative_array(const Jet& jet, int level) override;
  Projectors projectors(const Jet& jet, bool of_array) override;
  StrangenessFreeEquations strangeness_free(const Jet& jet) override;
  Jet accepted_point() const override;

 protected:
  std::unique_ptr<NonlinearSystem> copy_of_system() override;
  std::unique_ptr<NonlinearSystem> archived_system(const ModelOptions& options, Archive& archive) override;
  ConsistentPoint make_consistent(NonlinearSystem& system, const PointOfInterest& point,
                                  const ModelOptions& options) override;

 private:
  // keeps: keep the differential variables if possible.
  std::unique_ptr<NonlinearSystem> analyzed_near(const AnalysisSettings& settings, const PointOfInterest& point,
                                                 const ModelOptions& options, bool keeps,
                                                 std::vector<RankDecision>& decisions);
  std::unique_ptr<NonlinearSystem> analyzed(const AnalysisSettings& settings, const PointOfInterest& point,
                                            const ModelOptions& options, std::vector<RankDecision>& decisions);
  bool analyzed_by_structure(const PointOfInterest& point, const ModelOptions& options,
                             std::vector<RankDecision>& decisions);
  void demand_agreement();
  void give_up_structure();
  bool certifies_structure();
  // Largest move of a differential variable from the guess to the point of the analysis, in tolerances.
  double largest_move(const PointOfInterest& point, const ModelOptions& options) const;
  bool moves_least(const PointOfInterest& point, const ModelOptions& options);
  std::unique_ptr<NonlinearSystem> analyzed_against_whole_array(const PointOfInterest& point,
                                                                const ModelOptions& options,
                                                                std::vector<RankDecision>& decisions);

  std::unique_ptr<NonlinearSystem> consistent_copy(const PointOfInterest& point, const ModelOptions& options);
  Jet jet_after(const MovingJump& moving, const ModelOptions& options);

  RecordedProblem* recorded_ = nullptr;
  CallbackProblem* callback_ = nullptr;
  std::unique_ptr<NonlinearProblem> problem_;
  struct LastJump {
    std::vector<double> before;
    Jet jet;  // after it
  };
  LastJump last_jump_;
  std::unique_ptr<JumpDerivatives> jump_derivatives_;  // for the parameters asked for last
  bool replaced_follows_structure_ = false;            // of the problem, with the system that was replaced
  // x near which the analysis found its jet, keeping the differential variables if possible; empty if it did otherwise.
  std::vector<double> guess_;
};

}  // namespace sfdae::core
