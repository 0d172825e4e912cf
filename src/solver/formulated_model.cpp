// A problem with all its formulations.
// SPDX-License-Identifier: BSD-3-Clause
#include "solver/formulated_model.h"

#include <algorithm>

#include "linalg/index.h"
#include "multibody/consistent_motion.h"
#include "problem/failure.h"
#include "solver/choose_formulation.h"
#include "solver/status_of.h"

namespace sfdae::core {

std::unique_ptr<FormulatedModel> make_model(std::shared_ptr<const Record> record) {
  const EquationNames names = record->equation_names();
  if (record->is_linear())
    return formulated(std::make_unique<LinearModel>(
        std::make_unique<RecordedLinearCoefficients>(std::move(record), PrescribedInputs{})));
  auto problem = std::make_unique<RecordedProblem>(std::move(record), PrescribedInputs{});
  problem->set_equation_names(names);
  return formulated(std::make_unique<NonlinearModel>(std::move(problem)));
}

std::unique_ptr<FormulatedModel> FormulatedModel::clone() const {
  if (all_.linear != nullptr) return formulated(all_.linear->clone());
  return all_.nonlinear != nullptr ? formulated(all_.nonlinear->clone()) : formulated(all_.multibody->clone());
}

// ---- Equations -------------------------------------------------------------------------------------------------

void FormulatedModel::demand_structure(StructureUse wanted) const {
  if (wanted != StructureUse::required || has_structure()) return;
  refuse_argument(
      "structure = SFDAE_STRUCTURE_REQUIRED is for recorded equations, as many as unknowns, without prescribed "
      "components and differentiations.");
}

TaylorEvaluator* FormulatedModel::structure_evaluator() {
  return all_.multibody == nullptr && all_.equations != nullptr ? &all_.equations->evaluator() : evaluator();
}

bool FormulatedModel::follows_structure() const {
  const DaeSystem* const system = active_->system();
  return (system != nullptr && system->form() == SystemForm::extension) ||
         (all_.nonlinear != nullptr && all_.nonlinear->follows_structure());
}

EvaluationCounts FormulatedModel::evaluations() const {
  EvaluationCounts counts = all_.own->evaluations();
  const auto add = [&counts](const NonlinearProblem& problem) {
    counts.F += problem.evaluations();
    counts.linearizations += problem.linearizations();
  };
  if (all_.owned_equations) add(*all_.owned_equations);
  if (all_.array) add(all_.array->problem());
  if (instead_ != nullptr) {
    const EvaluationCounts more = instead_->evaluations();
    counts.E += more.E, counts.A += more.A, counts.f += more.f;
    counts.F += more.F, counts.linearizations += more.linearizations;
  }
  return counts;
}

void FormulatedModel::parameters_changed() {
  all_.own->parameters_changed();
  const TaylorEvaluator* const from = evaluator();
  for (int i = 0; from != nullptr && i < from->num_parameters(); ++i) {
    if (all_.owned_equations) all_.owned_equations->evaluator().set_parameter(i, from->parameter(i));
    if (all_.array) all_.array->evaluator()->set_parameter(i, from->parameter(i));
  }
}

void FormulatedModel::add_equations(WordHash& hash) {
  if (all_.multibody != nullptr || all_.equations == nullptr) all_.own->add_equations(hash);
  else core::add_equations(all_.equations->evaluator().record(), hash);
}

// ---- The formulation in use ------------------------------------------------------------------------------------

void FormulatedModel::analyze(const PointOfInterest& point, const ModelOptions& options,
                              std::vector<RankDecision>& decisions) {
  forget_system();
  options_ = options;
  active_ = &choose_formulation(all_, point, options, decisions);
}

void FormulatedModel::use_instead(FormulatedModel* other) {
  if (instead_ == nullptr) own_active_ = active_;
  instead_ = other;
  active_ = other != nullptr ? other : own_active_;
}

void FormulatedModel::forget_system() {
  instead_ = nullptr;
  active_ = all_.own.get();
  if (all_.extension) all_.extension->forget_system();
  if (all_.array) all_.array->forget_system();
  all_.own->forget_system();
}

void FormulatedModel::demand_derivatives(const PointOfInterest& point, const ModelOptions& options) {
  // Comparisons need dense matrices of all derivatives; by judgement.
  constexpr int most_compared = 1000;
  if (all_.has_source() && n() > most_compared) return;
  if (active_ == all_.own.get()) all_.own->demand_derivatives(point, options);
  else if (is_extended() && all_.has_source())
    all_.own->demand_derivatives_along(all_.extension->accepted_jet(), point, options);
}

std::unique_ptr<SensitivitySystem> FormulatedModel::sensitivities(std::vector<int> parameters) {
  const int redundant = system()->analysis().values.u;
  if (all_.multibody == nullptr || redundant == 0) return active_->sensitivities(std::move(parameters));
  // Forces are unknowns of the first-order equations, and must be unique.
  throw Failure(
      SFDAE_ILLEGAL_ARGUMENT,
      format("there are no sensitivities with redundant constraints, whose forces are not unique: %d of them "
             "depend on others. Leave these out.",
             redundant));
}

std::optional<Model::Extension> FormulatedModel::extension() {
  return all_.multibody != nullptr ? std::nullopt : active_->extension();
}

Jet FormulatedModel::accepted_point() const {
  return needs_x() ? active_->accepted_point() : all_.own->accepted_point();
}

// A search that stays at the point of the analysis starts from its values.
template <class Find>
ConsistentPoint FormulatedModel::with_consistent_motion(const PointOfInterest& point, const ModelOptions& options,
                                                        Find find) {
  MultibodyProblem& mechanical = all_.multibody->problem();
  const std::vector<double> given(point.x, point.x + n());
  std::vector<double> x = core::with_consistent_motion(mechanical, point, options);
  const Jet known = accepted_point();
  if (known.t == point.t && motion_stays(mechanical.sizes(), x, known.x)) x = known.x;
  ModelOptions plain = options;
  plain.consistency.kind = InitialValues::nearest;
  plain.consistency.weights.clear();
  plain.consistency.fixed.clear();
  ConsistentPoint found = find(PointOfInterest{point.t, point.toward, x.data()}, plain);
  const ConsistencyRequest request = options.request_at(given.data());
  report_change_of_motion(mechanical.sizes(), {request, point.t, given}, found);
  return found;
}

ConsistentPoint FormulatedModel::consistent_point(const PointOfInterest& point, const ModelOptions& options) {
  if (!has_consistent_motion()) return active_->consistent_point(point, options);
  return with_consistent_motion(point, options, [this](const PointOfInterest& near, const ModelOptions& plain) {
    return active_->consistent_point(near, plain);
  });
}

ConsistentPoint FormulatedModel::consistent_point_beside(const PointOfInterest& point, const ModelOptions& options) {
  if (!has_consistent_motion()) return active_->consistent_point_beside(point, options);
  return with_consistent_motion(point, options, [this](const PointOfInterest& near, const ModelOptions& plain) {
    return active_->consistent_point_beside(near, plain);
  });
}

// ---- Checkpoints -----------------------------------------------------------------------------------------------

bool FormulatedModel::expect(SystemForm form, bool for_sensitivities) {
  const bool is_extension = form == SystemForm::extension;
  if (instead_ != nullptr) {
    before_ = instead_;
    return instead_->expect(form, for_sensitivities);
  }
  if (is_extension && ((all_.multibody != nullptr && for_sensitivities) || !all_.make_extension())) return false;
  before_ = active_;
  active_ = all_.own.get();
  if (is_extension) {
    active_ = all_.extension.get();
  } else if (for_sensitivities && all_.has_array()) {
    all_.make_array();
    active_ = all_.array.get();
  }
  return true;
}

void FormulatedModel::restore(const ModelOptions& options, Archive& archive) {
  if (all_.equations != nullptr) all_.equations->allow_differences_in_time(options.differences.allowed);
  try {
    active_->restore(options, archive);
  } catch (...) {
    active_ = before_;
    throw;
  }
  options_ = options;
}

void FormulatedModel::undo_restore() {
  active_->undo_restore();
  active_ = before_;
}

void FormulatedModel::finish_restore() {
  active_->finish_restore();
  for (Model* model : {static_cast<Model*>(all_.extension.get()), static_cast<Model*>(all_.array.get()),
                       static_cast<Model*>(all_.own.get())})
    if (model != nullptr && model != active_) model->forget_system();
}

// ---- The problem's own formulation -----------------------------------------------------------------------------

void FormulatedModel::analyze_own() {
  ModelOptions options = options_;
  options.structure = StructureUse::off;
  const Jet jet = active_->accepted_point();
  std::vector<RankDecision> decisions;
  all_.own->analyze({jet.t, time_beside(jet.t, 1.0), jet.x.data()}, options, decisions);
}

WholeModel& FormulatedModel::whole() {
  if (instead_ != nullptr) return instead_->whole();
  if (all_.multibody != nullptr) return local_coordinates();
  if (active_ == all_.own.get() || all_.own->system() != nullptr) return *all_.own;
  if (n() > most_dense_unknowns)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        format("objects of the theory are those of the whole derivative array: there are none of more than %d "
               "unknowns.",
               most_dense_unknowns));
  analyze_own();
  return *all_.own;
}

WholeModel& FormulatedModel::same_whole() {
  WholeModel& model = whole();
  const CharacteristicValues &of_array = model.system()->analysis().values, &own = system()->analysis().values;
  if ((all_.multibody != nullptr && instead_ == nullptr) || of_array == own) return model;
  throw Failure(SFDAE_RANK_UNCLEAR,
                "the whole derivative array has other characteristic values, (" + describe(of_array) +
                    "), than those in use, (" + describe(own) +
                    "), which follow from structure: its objects do not fit. Set structure = SFDAE_STRUCTURE_OFF.");
}

MultibodyModel& FormulatedModel::local_coordinates() {
  MultibodyModel& local = *all_.multibody;
  if (!has_consistent_motion()) return local;
  const Jet jet = accepted_point();
  const MultibodySystem* known = local.system();
  if (known == nullptr || known->accepted_point().t != jet.t ||
      !std::equal(known->accepted_point().q.begin(), known->accepted_point().q.end(), jet.x.begin()))
    analyze_own();
  return local;
}

// Linear equations are differentiated as nonlinear ones.
bool FormulatedModel::differentiate_jump(const MovingJump& moving, const ModelOptions& options, View after) {
  if (instead_ != nullptr) return instead_->differentiate_jump(moving, options, after);
  if (all_.multibody != nullptr) return false;
  if (!all_.has_array()) return whole().differentiate_jump(moving, options, after);
  all_.make_array();
  NonlinearModel& array = *all_.array;
  if (array.system() == nullptr) {
    ModelOptions plain = options_;
    plain.structure = StructureUse::off;
    plain.for_sensitivities = true;
    std::vector<RankDecision> decisions;
    array.analyze({moving.t, moving.toward, moving.after}, plain, decisions);
  }
  return array.differentiate_jump(moving, options, after);
}

ConstraintsReport FormulatedModel::constraints() {
  return is_extended() ? constraints_at(all_.multibody->problem(), active_->accepted_point())
                       : local_coordinates().constraints();
}

}  // namespace sfdae::core
