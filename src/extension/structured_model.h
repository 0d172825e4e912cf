// Recorded equations that are solved by their minimal extension where structure and size suggest it and numbers confirm
// the structure, and by the derivative array elsewhere.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "array/nonlinear_model.h"
#include "extension/extension_model.h"
#include "system/model.h"

namespace sfdae::core {

class StructuredModel final : public Model {
 public:
  // classical: the same equations, by the whole array, recorded ones or functions with patterns. problem: these as
  // nonlinear equations; `owned` if that is another object than the one of the classical model, else null.
  StructuredModel(std::unique_ptr<Model> classical, RecordedProblem& problem, std::unique_ptr<RecordedProblem> owned);

  Problem& problem() override { return classical_->problem(); }
  int m() const override { return classical_->m(); }
  int n() const override { return classical_->n(); }
  bool is_constant() const override { return classical_->is_constant(); }
  bool needs_x() const override { return classical_->needs_x(); }
  bool has_structure() const override { return true; }
  EvaluationCounts evaluations() const override;
  TaylorEvaluator* evaluator() override { return classical_->evaluator(); }
  TaylorEvaluator* structure_evaluator() override { return &problem_.evaluator(); }
  void parameters_changed() override;
  std::vector<const TaylorEvaluator*> evaluators_of_inputs() override { return classical_->evaluators_of_inputs(); }

  void analyze(const PointOfInterest& point, const ModelOptions& options,
               std::vector<RankDecision>& decisions) override;
  void demand_derivatives(const PointOfInterest& point, const ModelOptions& options) override;
  bool expect(SystemForm form, bool for_sensitivities) override;
  void restore(const ModelOptions& options, Archive& archive) override;
  void undo_restore() override;
  void finish_restore() override;
  DaeSystem* system() override { return active().system(); }
  void forget_system() override;
  std::shared_ptr<const DaeSystem> shared_system() override { return active().shared_system(); }
  double certify() override { return active().certify(); }
  std::unique_ptr<ChangeWatch> change_watch() override { return active().change_watch(); }
  std::unique_ptr<SensitivitySystem> sensitivities(std::vector<int> parameters) override {
    return active().sensitivities(std::move(parameters));
  }
  ConsistentPoint consistent_point(const PointOfInterest& point, const ModelOptions& options) override {
    return active().consistent_point(point, options);
  }
  ConsistentPoint consistent_point_beside(const PointOfInterest& point, const ModelOptions& options) override {
    return active().consistent_point_beside(point, options);
  }

  std::optional<Extension> extension() override { return is_extended_ ? extended_.extension() : std::nullopt; }

  // The whole array is analyzed for them where that has not been done. Throws Failure where it is too large.
  Jump jump(const PointOfInterest& point, const ModelOptions& options) override {
    return whole().jump(point, options);
  }
  bool differentiate_jump(const MovingJump& moving, const ModelOptions& options, View after) override;
  Jet jet_through(double t, const double* x, int level) override { return whole().jet_through(t, x, level); }
  DerivativeArray derivative_array(const Jet& jet, int level) override {
    return whole().derivative_array(jet, level);
  }
  // Their sizes are those of the characteristic values in use: Failure where the whole array has others.
  Projectors projectors(const Jet& jet, bool of_array) override { return same_whole().projectors(jet, of_array); }
  StrangenessFreeEquations strangeness_free(const Jet& jet) override { return same_whole().strangeness_free(jet); }
  int level_of_jets(bool of_array) override { return same_whole().level_of_jets(of_array); }
  Jet accepted_point() const override;

 private:
  Model& active() {
    if (is_extended_) return extended_;
    return serves_nonlinear_ ? static_cast<Model&>(*nonlinear_) : *classical_;
  }
  bool may_extend(const ModelOptions& options);
  // Of unknowns at the guess, the largest over the smallest (docs/decisions/06-units-of-unknowns.md).
  double distance_of_units(const PointOfInterest& point);
  void analyze_extended(const PointOfInterest& point, const ModelOptions& options,
                        std::vector<RankDecision>& decisions);
  bool settle_doubt(const PointOfInterest& point, const ModelOptions& options, std::vector<RankDecision>& decisions);
  void analyze_as_nonlinear(const PointOfInterest& point, const ModelOptions& options,
                            std::vector<RankDecision>& decisions);
  void make_nonlinear();
  void undo_expectation();
  bool orders_are_possible() const;
  // Jacobians by differences have nothing else to be solved by.
  bool has_differences() const { return problem_.source() != nullptr && problem_.source()->has_differences(); }
  void demand_sensitivities();
  void demand_structure(const ModelOptions& options) const;
  Model& whole();
  Model& same_whole();
  // By an upper bound of its columns.
  bool is_array_large() const;

  std::unique_ptr<Model> classical_;
  std::unique_ptr<RecordedProblem> owned_;
  RecordedProblem& problem_;
  ExtensionModel extended_;
  bool is_extended_ = false, was_extended_ = false;
  // Linear equations as nonlinear ones, by the whole array: for sensitivities.
  std::unique_ptr<NonlinearModel> nonlinear_;
  bool serves_nonlinear_ = false, served_nonlinear_ = false;
  ModelOptions options_;  // of the last analysis
};

}  // namespace sfdae::core
