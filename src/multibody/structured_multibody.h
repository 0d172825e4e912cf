// Mechanical systems with constraints: large recorded ones by the minimal extension of their first-order equations,
// with sparse matrices, where numbers confirm their structure; those that sensitivities are asked of by the
// derivative array of these equations; all others by local coordinates, with dense matrices.
//
// K = [M C^T; C 0] of chains and trees has few entries in a row, and what follows from it, as projections and
// tangents, has many (docs/decisions/54-sparse-multibody-systems.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "array/nonlinear_model.h"
#include "extension/extension_model.h"
#include "multibody/multibody_model.h"
#include "system/model.h"

namespace sfdae::core {

class StructuredMultibody final : public Model {
 public:
  explicit StructuredMultibody(std::unique_ptr<MultibodyModel> local) : local_(std::move(local)) {}

  // Another one of the same recorded formulas; null for functions.
  std::unique_ptr<StructuredMultibody> clone() const;

  // ---- Those of any model ----

  MultibodyProblem& problem() override { return local_->problem(); }
  int m() const override { return local_->m(); }
  int n() const override { return local_->n(); }
  bool is_constant() const override { return false; }
  bool needs_x() const override { return true; }
  bool has_structure() const override { return local_->is_recorded(); }
  EvaluationCounts evaluations() const override;
  TaylorEvaluator* evaluator() override { return local_->evaluator(); }
  std::vector<const TaylorEvaluator*> evaluators_of_inputs() override { return local_->evaluators_of_inputs(); }
  void parameters_changed() override;
  void add_equations(WordHash& hash) override { local_->add_equations(hash); }

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
  double certify() override { return local_->certify(); }
  std::unique_ptr<ChangeWatch> change_watch() override { return active().change_watch(); }
  std::unique_ptr<SensitivitySystem> sensitivities(std::vector<int> parameters) override;
  ConsistentPoint consistent_point(const PointOfInterest& point, const ModelOptions& options) override;
  ConsistentPoint consistent_point_beside(const PointOfInterest& point, const ModelOptions& options) override;

  // These are made with local coordinates, at the point accepted last.
  Jump jump(const PointOfInterest& point, const ModelOptions& options) override {
    return local().jump(point, options);
  }
  Jet jet_through(double t, const double* x, int level) override { return local().jet_through(t, x, level); }
  DerivativeArray derivative_array(const Jet& jet, int level) override {
    return local().derivative_array(jet, level);
  }
  Projectors projectors(const Jet& jet, bool of_array) override { return local().projectors(jet, of_array); }
  StrangenessFreeEquations strangeness_free(const Jet& jet) override { return local().strangeness_free(jet); }
  int level_of_jets(bool of_array) override { return local().level_of_jets(of_array); }
  Jet accepted_point() const override;

  // ---- Those of multibody systems: as of MultibodyModel ----

  CallbackMultibody* callbacks() { return local_->callbacks(); }
  std::unique_ptr<RecordedProblem> recorded_first_order_problem() { return local_->recorded_first_order_problem(); }
  ConstraintsReport constraints();
  Jump impact(const PointOfInterest& point, const ModelOptions& options, const std::vector<double>& restitution) {
    return local().impact(point, options, restitution);
  }
  ExtendedSystem extended_system(double t, const double* x) { return local().extended_system(t, x); }

 private:
  // The first-order equations, and their minimal extension.
  struct Sparse {
    Sparse(std::unique_ptr<RecordedProblem> equations, Problem& base);
    std::unique_ptr<RecordedProblem> problem;
    ExtensionModel model;
  };

  enum class Form { local, sparse, array };
  Model& active();
  bool may_be_sparse(const ModelOptions& options);
  bool make_sparse();
  void analyze_sparse(const PointOfInterest& point, const ModelOptions& options,
                      std::vector<RankDecision>& decisions);
  void make_array();
  void analyze_array(const PointOfInterest& point, const ModelOptions& options, std::vector<RankDecision>& decisions);
  MultibodyModel& local();
  // The given x with consistent positions and velocities.
  std::vector<double> with_consistent_motion(const PointOfInterest& point, const ModelOptions& options);
  template <class Find>
  ConsistentPoint consistent(const PointOfInterest& point, const ModelOptions& options, Find find);

  std::unique_ptr<MultibodyModel> local_;
  std::unique_ptr<Sparse> sparse_;         // once it has been of use
  std::unique_ptr<NonlinearModel> array_;  // the first-order equations, for sensitivities
  Form form_ = Form::local, form_before_ = Form::local;
  ModelOptions options_;  // of the last analysis
};

}  // namespace sfdae::core
