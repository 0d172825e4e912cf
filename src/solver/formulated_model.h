// A problem with all its formulations, one of which is active: each analysis chooses it (choose_formulation.h), and all
// other functions use it. Matrices of the theory are those of the problem's own formulation, whichever is active.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "solver/formulations.h"

namespace sfdae::core {

class FormulatedModel final : public Model {
 public:
  explicit FormulatedModel(Formulations formulations) : all_(std::move(formulations)), active_(all_.own.get()) {}
  // Another model of the same recorded equations, with the present parameter values; the recording is shared.
  std::unique_ptr<FormulatedModel> clone() const;

  // The kind of problem: one of these is set, the others are null.
  LinearModel* linear() { return all_.linear; }
  NonlinearModel* nonlinear() { return all_.nonlinear; }
  MultibodyModel* multibody() { return all_.multibody; }
  // Throws Failure if the structural analysis is required but not possible.
  void demand_structure(StructureUse wanted) const;
  bool has_structure() const { return all_.has_structure(); }
  // The equations with a structure, recorded ones or functions with patterns; otherwise null.
  TaylorEvaluator* structure_evaluator();
  // True if the derivative array omits rows that the structural analysis does not require.
  bool follows_structure() const;
  // Uses another model of the problem, whose equations differ within tolerances only, until the next analysis; it has
  // been analyzed, or will be restored. Null: returns to the previous model.
  void use_instead(FormulatedModel* other);

  Problem& problem() override { return all_.own->problem(); }
  int m() const override { return all_.own->m(); }
  int n() const override { return all_.own->n(); }
  bool is_constant() const override { return all_.own->is_constant(); }
  bool needs_x() const override { return all_.own->needs_x(); }
  EvaluationCounts evaluations() const override;
  TaylorEvaluator* evaluator() override { return all_.own->evaluator(); }
  void parameters_changed() override;
  std::vector<const TaylorEvaluator*> evaluators_of_inputs() override { return all_.own->evaluators_of_inputs(); }
  void add_equations(WordHash& hash) override;

  void analyze(const PointOfInterest& point, const ModelOptions& options,
               std::vector<RankDecision>& decisions) override;
  void demand_derivatives(const PointOfInterest& point, const ModelOptions& options) override;
  bool expect(SystemForm form, bool for_sensitivities) override;
  void restore(const ModelOptions& options, Archive& archive) override;
  void undo_restore() override;
  void finish_restore() override;
  DaeSystem* system() override { return active_->system(); }
  void forget_system() override;
  std::shared_ptr<const DaeSystem> shared_system() override { return active_->shared_system(); }
  double certify() override { return active_->certify(); }
  std::unique_ptr<ChangeWatch> change_watch() override { return active_->change_watch(); }
  std::unique_ptr<SensitivitySystem> sensitivities(std::vector<int> parameters) override;
  ConsistentPoint consistent_point(const PointOfInterest& point, const ModelOptions& options) override;
  ConsistentPoint consistent_point_beside(const PointOfInterest& point, const ModelOptions& options) override;
  // Empty for mechanical systems: their report has the constraints instead.
  std::optional<Extension> extension() override;
  Jet accepted_point() const override;

  // The problem's own formulation, analyzed at the point of the active one. Both throw Failure if it is too large,
  // same_whole() also if its characteristic values differ from those in use.
  WholeModel& whole();
  WholeModel& same_whole();
  // The corresponding formulation of a mechanical system.
  MultibodyModel& local_coordinates();
  bool differentiate_jump(const MovingJump& moving, const ModelOptions& options, View after);
  // The constraints of a mechanical system at the point accepted last.
  ConstraintsReport constraints();

  bool fulfils_equations(const PointOfInterest& point) { return all_.own->fulfils_equations(point); }
  // True if consistent values are those of the motion of a mechanical system.
  bool has_consistent_motion() const { return all_.multibody != nullptr && active_ != all_.own.get(); }

 private:
  bool is_extended() const { return active_ == all_.extension.get(); }
  void analyze_own();
  template <class Find>
  ConsistentPoint with_consistent_motion(const PointOfInterest& point, const ModelOptions& options, Find find);

  Formulations all_;
  FormulatedModel* instead_ = nullptr;
  Model* own_active_ = nullptr;        // active_ without instead_
  Model *active_, *before_ = nullptr;  // before_: previous one while a checkpoint is restored
  ModelOptions options_;               // of the last analysis
};

template <class Kind>
std::unique_ptr<FormulatedModel> formulated(std::unique_ptr<Kind> model) {
  return std::make_unique<FormulatedModel>(Formulations(std::move(model)));
}
// Linear recorded equations become a linear model.
std::unique_ptr<FormulatedModel> make_model(std::shared_ptr<const Record> record);

}  // namespace sfdae::core
