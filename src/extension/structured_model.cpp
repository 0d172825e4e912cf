// Recorded equations by their minimal extension, or by the derivative array.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/structured_model.h"

#include <algorithm>
#include <utility>

#include "expression/series.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/usual_units.h"
#include "system/jet_coefficients.h"

namespace sfdae::core {

namespace {

// Columns of the derivative array from which on the extension is taken (docs/decisions/47-minimal-extension.md).
// Where nothing has to be differentiated it is the equations as they are
// (docs/decisions/90-small-problems-of-index-zero.md).
constexpr double least_array = 100.0, least_array_as_recorded = 20.0;
// Units of unknowns that are so far apart lead arrays astray, or may have done so
// (docs/decisions/84-units-of-blocks.md). By judgement.
constexpr double far_apart = 65536.0, apart = 1024.0;

}  // namespace

StructuredModel::StructuredModel(std::unique_ptr<Model> classical, RecordedProblem& problem,
                                 std::unique_ptr<RecordedProblem> owned)
    : classical_(std::move(classical)),
      owned_(std::move(owned)),
      problem_(problem),
      extended_(problem_, classical_->problem()) {
  if (owned_) owned_->stop_with(classical_->problem());
}

EvaluationCounts StructuredModel::evaluations() const {
  EvaluationCounts counts = classical_->evaluations();
  const auto add = [&counts](const NonlinearProblem& problem) {
    counts.F += problem.evaluations();
    counts.linearizations += problem.linearizations();
  };
  if (owned_) add(*owned_);
  if (nonlinear_) add(nonlinear_->problem());
  return counts;
}

void StructuredModel::parameters_changed() {
  classical_->parameters_changed();
  if (!owned_ || classical_->evaluator() == nullptr) return;
  const TaylorEvaluator& from = *classical_->evaluator();
  for (int i = 0; i < from.num_parameters(); ++i) {
    owned_->evaluator().set_parameter(i, from.parameter(i));
    if (nonlinear_) nonlinear_->evaluator()->set_parameter(i, from.parameter(i));
  }
}

bool StructuredModel::is_array_large() const {
  const int bound = problem_.structure()->offsets.index_bound();
  const double columns = static_cast<double>(classical_->n()) * (bound + 1);
  return columns >= (bound == 0 ? least_array_as_recorded : least_array);
}

// At the guess.
double StructuredModel::distance_of_units(const PointOfInterest& point) {
  Jet jet;
  jet.t = point.t;
  jet.n = n();
  jet.set_order(1);
  if (point.x != nullptr) std::copy_n(point.x, n(), jet.column(0));
  if (point.xdot != nullptr) std::copy_n(point.xdot, n(), jet.column(1));
  JetCoefficients source(problem_, jet, {});
  try {
    const UsualUnits usual = usual_units(source, point.t);
    const std::vector<double>& units = usual.units.values();
    const auto [smallest, largest] = std::minmax_element(units.begin(), units.end());
    return units.empty() ? 1.0 : *largest / *smallest;
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return 1.0;
  }
}

bool StructuredModel::may_extend(const ModelOptions& options) {
  return options.structure == StructureUse::automatic && !options.for_adjoint && !options.analysis.by_svd &&
         options.leading == LeadingTerm::automatic && options.consistency.kind != InitialValues::keep_differential &&
         problem_.structure() != nullptr && orders_are_possible();
}

// Of Taylor series of the equations, and of those of their derivatives by t.
bool StructuredModel::orders_are_possible() const {
  const std::vector<int>& c = problem_.structure()->offsets.c;
  return *std::max_element(c.begin(), c.end()) + 1 <= series::highest_order;
}

void StructuredModel::analyze(const PointOfInterest& point, const ModelOptions& options,
                              std::vector<RankDecision>& decisions) {
  forget_system();
  options_ = options;
  const bool is_required = options.structure == StructureUse::required || has_differences();
  if (is_required) demand_structure(options);
  const bool may_be_extended = is_required || may_extend(options);
  // Who has some values stay, or move less, wants those near the guess, or none: the extension may find others.
  const bool takes_any_values =
      options.consistency.kind == InitialValues::nearest && options.consistency.weights.empty();
  const auto units_are = [&](double distance) {
    return may_be_extended && takes_any_values && distance_of_units(point) > distance;
  };
  const bool is_extended_first = is_required || (may_be_extended && is_array_large()) || units_are(far_apart);
  if (is_extended_first) {
    try {
      analyze_extended(point, options, decisions);
      return;
    } catch (const Failure& failure) {
      if (is_required || ends_everything(failure.status()) || n() > most_dense_unknowns) throw;
    }
    decisions.clear();
  }
  demand_dense(n());
  try {
    if (options.for_sensitivities && owned_) analyze_as_nonlinear(point, options, decisions);
    else classical_->analyze(point, options, decisions);
  } catch (const Failure& failure) {
    if (!may_be_extended || is_extended_first) throw;
    const bool is_led_astray = failure.status() == SFDAE_NO_CONSISTENT_VALUES && units_are(apart);
    if (failure.status() != SFDAE_RANK_UNCLEAR && !is_led_astray) throw;
    if (!settle_doubt(point, options, decisions)) throw;
  }
}

void StructuredModel::analyze_extended(const PointOfInterest& point, const ModelOptions& options,
                                       std::vector<RankDecision>& decisions) {
  problem_.follow_structure(false);
  problem_.allow_differences_in_time(options.differences.allowed);
  extended_.analyze(point, options, decisions);
  if (options.for_sensitivities) demand_sensitivities();
  is_extended_ = true;
}

// Large arrays of uneven units may be beyond double precision where the few equations that structure asks for are
// not. These have certificates of their own; without one the array's failure stands, with its decisions.
bool StructuredModel::settle_doubt(const PointOfInterest& point, const ModelOptions& options,
                                   std::vector<RankDecision>& decisions) {
  std::vector<RankDecision> of_extension;
  try {
    analyze_extended(point, options, of_extension);
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return false;
  }
  decisions = std::move(of_extension);
  return true;
}

// Equations that are replaced have them by the whole array alone.
void StructuredModel::demand_sensitivities() {
  if (extended_.has_sensitivities()) return;
  extended_.forget_system();
  throw Failure(
      SFDAE_ILLEGAL_ARGUMENT,
      "structure = SFDAE_STRUCTURE_REQUIRED and sensitivities exclude each other where structure misleads and "
      "equations are replaced: these are computed with the whole derivative array.");
}

// Where it has to be used.
void StructuredModel::demand_structure(const ModelOptions& options) const {
  if (has_differences() && options.structure == StructureUse::off)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        "structure = SFDAE_STRUCTURE_OFF and SFDAE_MATRICES_DIFFERENCES exclude each other: the whole array "
        "needs Jacobians.");
  if (problem_.shared_structure() == nullptr)
    throw Failure(SFDAE_RANK_UNCLEAR,
                  "the option structure, or Jacobians by differences, require what these equations do not have: some "
                  "contain too few unknowns, as sfdae_get_structure tells.");
  if (options.for_adjoint) demand_array_for_sensitivities(options);
  if (!orders_are_possible())
    throw Failure(SFDAE_INDEX_TOO_HIGH,
                  format("structure asks for more than %d derivatives of an equation.", series::highest_order - 1));
}

void StructuredModel::analyze_as_nonlinear(const PointOfInterest& point, const ModelOptions& options,
                                           std::vector<RankDecision>& decisions) {
  if (point.x == nullptr)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        "with sensitivities linear equations are analyzed as nonlinear ones, at values: call sfdae_analyze_at.");
  make_nonlinear();
  nonlinear_->analyze(point, options, decisions);
  serves_nonlinear_ = true;
}

void StructuredModel::make_nonlinear() {
  if (nonlinear_) return;
  auto model = std::make_unique<NonlinearModel>(std::make_unique<RecordedProblem>(owned_->evaluator()));
  model->problem().set_equation_names(classical_->problem().equation_names());
  model->problem().stop_with(classical_->problem());
  nonlinear_ = std::move(model);
}

void StructuredModel::demand_derivatives(const PointOfInterest& point, const ModelOptions& options) {
  // Comparisons take matrices of all derivatives; by judgement.
  constexpr int most_compared = 1000;
  if (serves_nonlinear_ || (problem_.source() != nullptr && n() > most_compared)) return;
  if (!is_extended_) classical_->demand_derivatives(point, options);
  else if (problem_.source() != nullptr)
    classical_->demand_derivatives_along(extended_.accepted_jet(), point, options);
}

void StructuredModel::forget_system() {
  is_extended_ = serves_nonlinear_ = false;
  extended_.forget_system();
  if (nonlinear_) nonlinear_->forget_system();
  classical_->forget_system();
}

bool StructuredModel::expect(SystemForm form, bool for_sensitivities) {
  const bool is_extension = form == SystemForm::extension;
  if (is_extension && problem_.structure() == nullptr) return false;
  if (for_sensitivities && owned_ && !is_extension) make_nonlinear();
  was_extended_ = is_extended_;
  served_nonlinear_ = serves_nonlinear_;
  is_extended_ = is_extension;
  serves_nonlinear_ = for_sensitivities && owned_ != nullptr && !is_extension;
  return true;
}

void StructuredModel::undo_expectation() {
  is_extended_ = was_extended_;
  serves_nonlinear_ = served_nonlinear_;
}

void StructuredModel::restore(const ModelOptions& options, Archive& archive) {
  problem_.allow_differences_in_time(options.differences.allowed);
  try {
    active().restore(options, archive);
  } catch (...) {
    undo_expectation();
    throw;
  }
  options_ = options;
}

void StructuredModel::undo_restore() {
  active().undo_restore();
  undo_expectation();
}

void StructuredModel::finish_restore() {
  Model& now = active();
  now.finish_restore();
  for (Model* model : {static_cast<Model*>(&extended_), static_cast<Model*>(nonlinear_.get()), classical_.get()})
    if (model != nullptr && model != &now) model->forget_system();
}

Model& StructuredModel::whole() {
  if ((!is_extended_ && !serves_nonlinear_) || classical_->system() != nullptr) return *classical_;
  if (n() > most_dense_unknowns)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        format("objects of the theory are those of the whole derivative array: there are none of more than %d "
               "unknowns.",
               most_dense_unknowns));
  if (has_differences())
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        "objects of the theory are those of the whole derivative array, which needs Jacobians: there are none "
        "with SFDAE_MATRICES_DIFFERENCES.");
  ModelOptions options = options_;
  options.structure = StructureUse::off;
  const Jet jet = is_extended_ ? extended_.accepted_point() : nonlinear_->accepted_point();
  std::vector<RankDecision> decisions;
  classical_->analyze({jet.t, time_beside(jet.t, 1.0), jet.x.data()}, options, decisions);
  return *classical_;
}

// Linear equations as nonlinear ones.
bool StructuredModel::differentiate_jump(const MovingJump& moving, const ModelOptions& options, View after) {
  if (!owned_) return whole().differentiate_jump(moving, options, after);
  make_nonlinear();
  if (nonlinear_->system() == nullptr) {
    ModelOptions plain = options_;
    plain.structure = StructureUse::off;
    plain.for_sensitivities = true;
    std::vector<RankDecision> decisions;
    nonlinear_->analyze({moving.t, moving.toward, moving.after}, plain, decisions);
  }
  return nonlinear_->differentiate_jump(moving, options, after);
}

Model& StructuredModel::same_whole() {
  Model& model = whole();
  const CharacteristicValues &of_array = model.system()->analysis().values, &own = system()->analysis().values;
  if (of_array == own) return model;
  throw Failure(SFDAE_RANK_UNCLEAR,
                "the whole derivative array has other characteristic values, (" + describe(of_array) +
                    "), than those in use, (" + describe(own) +
                    "), which follow from structure: its objects do not fit. Set structure = SFDAE_STRUCTURE_OFF.");
}

Jet StructuredModel::accepted_point() const {
  return is_extended_ && classical_->needs_x() ? extended_.accepted_point() : classical_->accepted_point();
}

}  // namespace sfdae::core
