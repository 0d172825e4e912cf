// A problem with all its formulations, one of which is in use: each analysis chooses it (choose_formulation.h), and
// everything else asks that one. Objects of the theory are those of the problem's own formulation, whichever is in
// use.
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
  // Another one of the same recorded equations, with the values that parameters have now; the recording is shared.
  std::unique_ptr<FormulatedModel> clone() const;

  // The kind of problem: one of these, the others are null.
  LinearModel* linear() { return all_.linear; }
  NonlinearModel* nonlinear() { return all_.nonlinear; }
  MultibodyModel* multibody() { return all_.multibody; }
  // Throws Failure where the structure has to be followed and there is none.
  void demand_structure(StructureUse wanted) const;
  bool has_structure() const { return all_.has_structure(); }
  // The equations that have a structure, recorded ones or functions with patterns; else null.
  TaylorEvaluator* structure_evaluator();
  // Rows of the derivative array that structure does not ask for are left out.
  bool follows_structure() const;
  // A model of the same problem, with equations that differ from its own within tolerances only, that is in use until
  // the next analysis; it has been analyzed, or is to be restored. Null: the one before it is in use again.
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
  // None for mechanical systems: a report has the constraints instead.
  std::optional<Extension> extension() override;
  Jet accepted_point() const override;

  // The problem's own formulation, analyzed where the active one is. Throws Failure where it is too large, and the
  // second where it has other characteristic values than those in use.
  WholeModel& whole();
  WholeModel& same_whole();
  // The same of a mechanical system.
  MultibodyModel& local_coordinates();
  bool differentiate_jump(const MovingJump& moving, const ModelOptions& options, View after);
  // The constraints of a mechanical system at the point accepted last.
  ConstraintsReport constraints();

  bool fulfils_equations(const PointOfInterest& point) { return all_.own->fulfils_equations(point); }
  // Returns whether consistent values are those of the motion of a mechanical system.
  bool has_consistent_motion() const { return all_.multibody != nullptr && active_ != all_.own.get(); }

 private:
  bool is_extended() const { return active_ == all_.extension.get(); }
  void analyze_own();
  template <class Find>
  ConsistentPoint with_consistent_motion(const PointOfInterest& point, const ModelOptions& options, Find find);

  Formulations all_;
  FormulatedModel* instead_ = nullptr;
  Model* own_active_ = nullptr;        // without it
  Model *active_, *before_ = nullptr;  // before: when a checkpoint is restored
  ModelOptions options_;               // of the last analysis
};

template <class Kind>
std::unique_ptr<FormulatedModel> formulated(std::unique_ptr<Kind> model) {
  return std::make_unique<FormulatedModel>(Formulations(std::move(model)));
}
// Recorded equations that are linear become a linear model.
std::unique_ptr<FormulatedModel> make_model(std::shared_ptr<const Record> record);

}  // namespace sfdae::core
