// A linear problem as the API sees it.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/linear_model.h"

#include <cmath>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"
#include "system/change_watch.h"

namespace sfdae::core {

std::unique_ptr<Model> linear_model(const sfdae_linear_problem& problem) {
  return std::make_unique<LinearModel>(problem);
}

void demand_finite_derivative(const std::vector<double>& xdot, double t) {
  if (!all_finite(xdot.data(), xdot.size()))
    throw Failure(SFDAE_NOT_FINITE, format("the derivative of the initial values overflows at t = %.15g.", t));
}

std::unique_ptr<DaeSystem> LinearModel::analyze(const PointOfInterest& point, const SolverOptions& options,
                                                std::vector<RankDecision>& decisions) {
  DifferenceOptions differences = options.differences;
  differences.span = std::fabs(point.toward - point.t);
  problem_.set_differences(differences);
  Arena arena;
  IndexAnalysis analysis = analyze_index(problem_, point.t, point.toward, options.analysis, arena, decisions);
  return std::make_unique<LinearSystem>(problem_, options.analysis, std::move(analysis), options.leading);
}

std::unique_ptr<DaeSystem> LinearModel::copy_of(const DaeSystem& system, const SolverOptions& options) {
  return std::make_unique<LinearSystem>(problem_, options.analysis, system.analysis(), system.leading_term());
}

namespace {

void move_system(DaeSystem& system, double t) {
  PointStatus status = system.move_to(t);
  if (status == PointStatus::leading_changed) {
    system.give_up_projector();
    status = system.move_to(t);
  }
  if (status == PointStatus::callback_error)
    throw Failure(system.callback_error().status, system.callback_error().message());
  if (status == PointStatus::changed)
    throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                  "the characteristic values known (" + describe(system.analysis().values) +
                      format(") do not hold at t = %.15g. Call sfdae_analyze there.", t));
}

}  // namespace

Consistent LinearModel::consistent_values(DaeSystem& any_system, const SolverOptions& options,
                                          const PointOfInterest& point) {
  LinearSystem& system = static_cast<LinearSystem&>(any_system);
  const double t = point.t;
  move_system(system, t);
  Consistent result;
  const IntegrationOptions& integration = options.integration;
  if (system.inconsistency() > integration.consistency_tol) {
    if (!integration.ignore_inconsistency)
      throw Failure(SFDAE_INCONSISTENT_EQUATIONS, system.inconsistency_message());
    result.contradiction = true;
  }
  result.x.assign(point.x, point.x + n());
  ConsistencyRequest request = options.consistency;
  request.set_tolerances(integration.tolerances.rtol, integration.tolerances.atol, point.x);
  const ConsistencyResult found = make_consistent(system, request, result.x);
  result.xdot.resize(index(n()));
  const bool exact = system.consistent_derivative(result.x.data(), point.toward < t ? -1.0 : 1.0, result.xdot.data());
  demand_finite_derivative(result.xdot, t);
  result.report = {sizeof(sfdae_initial_report),
                   t,
                   found.residual_before,
                   found.residual_after,
                   found.largest_change,
                   found.component,
                   exact ? 1 : 0};
  return result;
}

std::unique_ptr<ChangeDetector> LinearModel::detector(DaeSystem& system) {
  return std::make_unique<ChangeWatch>(static_cast<LinearSystem&>(system));
}

void LinearModel::count_evaluations(sfdae_statistics& statistics) const {
  statistics.evaluations_E = problem_.evaluations('E');
  statistics.evaluations_A = problem_.evaluations('A');
  statistics.evaluations_f = problem_.evaluations('f');
}

}  // namespace sfdae::core
