// A linear problem with its system.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/linear_model.h"

#include <cmath>

#include "problem/failure.h"

namespace sfdae::core {

LinearModel::LinearModel(std::unique_ptr<RecordedLinearCoefficients> coefficients)
    : recorded_(std::move(coefficients)), problem_(recorded_->functions()) {
  problem_.set_explanation([recorded = recorded_.get()] { return recorded->failure(); });
}

EvaluationCounts LinearModel::evaluations() const {
  return {.E = problem_.evaluations('E'), .A = problem_.evaluations('A'), .f = problem_.evaluations('f')};
}

void LinearModel::parameters_changed() {
  if (!recorded_) return;
  recorded_->forget();
  problem_.forget_constants();
}

void LinearModel::analyze(const PointOfInterest& point, const ModelOptions& options,
                          std::vector<RankDecision>& decisions) {
  forget_system();
  DifferenceOptions differences = options.differences;
  differences.span = std::fabs(point.toward - point.t);
  problem_.set_differences(differences);
  Arena arena;
  IndexAnalysis analysis = analyze_index(problem_, point.t, point.toward, options.analysis, arena, decisions);
  system_ = std::make_unique<LinearSystem>(problem_, options.analysis, std::move(analysis), options.leading);
}

void LinearModel::restore(const ModelOptions& options, Archive& archive) {
  problem_.set_differences(options.differences);
  system_ = std::make_unique<LinearSystem>(problem_, options.analysis, archive);
}

std::unique_ptr<LinearSystem> LinearModel::copy_of_system() {
  return std::make_unique<LinearSystem>(problem_, system_->settings(), system_->analysis(), system_->leading_term());
}

bool LinearModel::set_point(LinearSystem& system, double t, const ModelOptions& options) {
  PointStatus status = system.move_to(t);
  if (status == PointStatus::leading_changed) {
    system.give_up_projector();
    status = system.move_to(t);
  }
  if (status == PointStatus::callback_error || status == PointStatus::changed)
    demand_point(system, status, t, "Call sfdae_analyze there.");
  if (system.quality().inconsistency <= options.consistency_tol) return false;
  if (!options.ignore_inconsistency) throw Failure(SFDAE_INCONSISTENT_EQUATIONS, system.inconsistency_message());
  return true;
}

ConsistentPoint LinearModel::make_consistent(LinearSystem& system, const PointOfInterest& point,
                                             const ModelOptions& options) {
  ConsistentPoint result;
  result.t = point.t;
  result.has_contradiction = set_point(system, point.t, options);
  const std::vector<double> given(point.x, point.x + n());
  ConsistencyRequest request = options.request_at(point.x);
  request.trusts_digits = request.differentiated_stay();
  ValueChange change;
  const auto choose = [&] {
    result.x = given;
    result.change = core::make_consistent(system, request, result.x);
    change = change_of_differentiated(constraints_of(system), request, given, result.x);
  };
  choose();
  if (request.trusts_digits && change.is_beyond_tolerances()) {
    request.trusts_digits = false;
    choose();
  }
  if (request.reports_changes()) result.value_change = change;
  add_derivative(system, point.direction(), result);
  return result;
}

Projectors LinearModel::projectors(double t) {
  return core::projectors(problem_, system_->analysis(), system_->settings(), t);
}

}  // namespace sfdae::core
