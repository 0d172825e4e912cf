// A problem that one of several formulations serves.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/formulated_model.h"

#include <utility>

#include "problem/failure.h"

namespace sfdae::core {

void FormulatedModel::set_equations(RecordedProblem& equations, std::unique_ptr<RecordedProblem> owned) {
  owned_ = std::move(owned);
  equations_ = &equations;
  extended_ = std::make_unique<ExtensionModel>(equations, problem());
  if (owned_) owned_->stop_with(problem());
}

void FormulatedModel::make_array() {
  if (array_) return;
  auto model = std::make_unique<NonlinearModel>(equations_of_array());
  model->problem().stop_with(problem());
  array_ = std::move(model);
}

Model& FormulatedModel::active() const {
  if (formulation_ == Formulation::extension) return *extended_;
  return formulation_ == Formulation::array ? static_cast<Model&>(*array_) : *own_;
}

EvaluationCounts FormulatedModel::evaluations() const {
  EvaluationCounts counts = own_->evaluations();
  const auto add = [&counts](const NonlinearProblem& problem) {
    counts.F += problem.evaluations();
    counts.linearizations += problem.linearizations();
  };
  if (owned_) add(*owned_);
  if (array_) add(array_->problem());
  return counts;
}

void FormulatedModel::parameters_changed() {
  own_->parameters_changed();
  const TaylorEvaluator* const from = own_->evaluator();
  for (int i = 0; from != nullptr && i < from->num_parameters(); ++i) {
    if (owned_) owned_->evaluator().set_parameter(i, from->parameter(i));
    if (array_) array_->evaluator()->set_parameter(i, from->parameter(i));
  }
}

// ---- Which formulation serves ----------------------------------------------------------------------------------

void FormulatedModel::analyze(const PointOfInterest& point, const ModelOptions& options,
                              std::vector<RankDecision>& decisions) {
  forget_system();
  options_ = options;
  formulation_ = choose_formulation(point, options, decisions);
}

// The one that has been analyzed.
Formulation FormulatedModel::choose_formulation(const PointOfInterest& point, const ModelOptions& options,
                                                std::vector<RankDecision>& decisions) {
  const bool is_required = requires_extension(options);
  const bool may_be_extended = is_required || may_extend(options);
  const bool is_first = is_required || (may_be_extended && is_extended_first(point, options));
  if (is_first) {
    try {
      analyze_as(Formulation::extension, point, options, decisions);
      return Formulation::extension;
    } catch (const Failure& failure) {
      if (is_required || ends_everything(failure.status()) || !are_others_possible()) throw;
    }
    decisions.clear();
  }
  const Formulation other =
      options.for_sensitivities && has_array_for_sensitivities() ? Formulation::array : Formulation::own;
  try {
    analyze_as(other, point, options, decisions);
  } catch (const Failure& failure) {
    if (!may_be_extended || is_first || !is_in_doubt(failure, point, options)) throw;
    if (!settle_doubt(point, options, decisions)) throw;
    return Formulation::extension;
  }
  return other;
}

// Large arrays of uneven units may be beyond double precision where the few equations that structure asks for are
// not. These have certificates of their own; without one the array's failure stands, with its decisions.
bool FormulatedModel::settle_doubt(const PointOfInterest& point, const ModelOptions& options,
                                   std::vector<RankDecision>& decisions) {
  std::vector<RankDecision> of_extension;
  try {
    analyze_as(Formulation::extension, point, options, of_extension);
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return false;
  }
  decisions = std::move(of_extension);
  return true;
}

Model& FormulatedModel::analyze_own() {
  ModelOptions options = options_;
  options.structure = StructureUse::off;
  const Jet jet = active().accepted_point();
  std::vector<RankDecision> decisions;
  own_->analyze({jet.t, time_beside(jet.t, 1.0), jet.x.data()}, options, decisions);
  return *own_;
}

void FormulatedModel::forget_system() {
  formulation_ = Formulation::own;
  if (extended_) extended_->forget_system();
  if (array_) array_->forget_system();
  own_->forget_system();
}

// ---- Checkpoints -----------------------------------------------------------------------------------------------

bool FormulatedModel::expect(SystemForm form, bool for_sensitivities) {
  const bool is_extension = form == SystemForm::extension;
  if (is_extension && !has_archived_extension(for_sensitivities)) return false;
  const bool is_array = !is_extension && for_sensitivities && has_array_for_sensitivities();
  if (is_array) make_array();
  before_ = formulation_;
  formulation_ = is_extension ? Formulation::extension : is_array ? Formulation::array : Formulation::own;
  return true;
}

void FormulatedModel::restore(const ModelOptions& options, Archive& archive) {
  try {
    active().restore(options, archive);
  } catch (...) {
    formulation_ = before_;
    throw;
  }
  options_ = options;
}

void FormulatedModel::undo_restore() {
  active().undo_restore();
  formulation_ = before_;
}

void FormulatedModel::finish_restore() {
  Model& now = active();
  now.finish_restore();
  for (Model* model : {static_cast<Model*>(extended_.get()), static_cast<Model*>(array_.get()), own_.get()})
    if (model != nullptr && model != &now) model->forget_system();
}

}  // namespace sfdae::core
