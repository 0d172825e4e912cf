// A linear problem with its system.
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/linear_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linear/linear_values.h"
#include "problem/derivative_check.h"
#include "problem/failure.h"
#include "starts/consistent_values.h"
#include "starts/impulses.h"
#include "starts/jet_theory.h"

namespace sfdae::core {

namespace {

// Requests to a problem may need other units and other spacings for finite differences of higher orders. The settings
// in use are restored when this ends, as the system and an integration continue with them.
class SameSettings {
 public:
  explicit SameSettings(LinearProblem& problem) : problem_(problem), settings_(problem.settings()) {}
  SameSettings(const SameSettings&) = delete;
  SameSettings& operator=(const SameSettings&) = delete;
  ~SameSettings() { problem_.set_settings(std::move(settings_)); }

 private:
  LinearProblem& problem_;
  LinearProblem::Settings settings_;
};

}  // namespace

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
  IndexAnalysis analysis =
      analyze_index(problem_, point.t, point.toward, options.analysis_by_precedent(), arena, decisions);
  system_ = std::make_unique<LinearSystem>(problem_, options.analysis, std::move(analysis), options.leading);
}

void LinearModel::demand_derivatives(const PointOfInterest& point, const ModelOptions& options) {
  // Orders checked after a failed analysis: wrong derivatives of low orders are the most frequent and the first to
  // matter.
  constexpr int orders_of_failure = 3;
  if (recorded_) return;
  const int wanted = system_ ? system_->analysis().values.mu + 1 : orders_of_failure;
  core::demand_derivatives(problem_, point.t, point.toward,
                           std::clamp(wanted, 1, std::max(options.analysis.max_index, 1)));
}

std::unique_ptr<LinearSystem> LinearModel::archived_system(const ModelOptions& options, Archive& archive) {
  LinearProblem::Settings before = problem_.settings();
  try {
    problem_.set_differences(options.differences);
    auto system = std::make_unique<LinearSystem>(problem_, options.analysis, archive);
    settings_before_ = std::move(before);
    return system;
  } catch (...) {
    problem_.set_settings(std::move(before));
    throw;
  }
}

void LinearModel::undo_restore() {
  ModelOf::undo_restore();
  problem_.set_settings(std::move(settings_before_));
}

std::unique_ptr<LinearSystem> LinearModel::copy_of_system() {
  return std::make_unique<LinearSystem>(problem_, system_->settings(), system_->analysis(), system_->leading_term());
}

double LinearModel::certify() {
  const SameSettings same(problem_);
  const IndexAnalysis& known = system_->analysis();
  Arena arena;
  return certified_distance(problem_, known.t, known, system_->settings(), arena);
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
  const ConsistencyRequest request = options.request_at(point.x);
  const ConstrainedPoint constraints = constraints_of(system);
  ValueChange change;
  const auto choose = [&](const ConsistencyRequest& way) {
    result.x = given;
    try {
      result.change = core::make_consistent(system, constraints, way, result.x);
    } catch (const Failure& failure) {
      if (failure.status() != SFDAE_FIXED_VALUES) throw;
      throw Failure(SFDAE_FIXED_VALUES, failure.what() + system.named_contradiction(way.fixed, given.data()));
    }
    change = change_of_differentiated(constraints, way, given, result.x);
  };
  const bool may_trust = request.differentiated_stay();
  choose(may_trust ? request.trusting_digits(point.x) : request);
  if (may_trust && change.is_beyond_tolerances()) choose(request);
  if (request.reports_changes()) result.value_change = change;
  add_derivative(system, point.direction(), result);
  return result;
}

Jump LinearModel::jump(const PointOfInterest& point, const ModelOptions& options) {
  const SameSettings same(problem_);
  const std::unique_ptr<LinearSystem> copy = copy_of_system();
  set_point(*copy, point.t, options);
  const ConstrainedPoint constraints = constraints_of(*copy);
  const InputsAfter inputs{problem_.prescribed(), {}};
  return jump_by_impulses({constraints, constraints.data, copy->analysis().values.mu, inputs},
                          {point.x, point.x + n()});
}

DerivativeArray LinearModel::derivative_array(double t, int level) {
  const SameSettings same(problem_);
  return core::derivative_array(problem_, t, level);
}

Projectors LinearModel::projectors(double t) {
  const SameSettings same(problem_);
  return core::projectors(problem_, system_->analysis(), system_->settings(), t);
}

// The derivatives y of least norm with M y = N x + g, in the units of the analysis and with rows of size 1.
Jet LinearModel::jet_through(double t, const double* x, int level) {
  // Smaller singular values, relative, are rounding errors of the derivative array. Residuals of x above the second
  // constant, relative to the terms of the sum, are errors of the user. If constants cancel and x = 0, the last allows
  // some roundings of values of size 1. Chosen, not measured.
  constexpr double rounding = 1e-13, consistent_residual = 1e-9, cancelled = 1e-14;
  const int highest = std::max(level, system_->analysis().values.mu);
  DerivativeArray array = derivative_array(t, highest);
  const int rows = array.M.rows(), size = array.M.cols();
  Jet jet;
  jet.t = t;
  jet.n = n();
  jet.x.assign(x, x + n());
  jet.set_order(highest + 1);
  move_to_jet(jet, array);  // the remainder with y = 0
  std::vector<double> unit(index(size));
  for (int j = 0; j < size; ++j)
    unit[index(j)] = problem_.units()[j % n()] / std::pow(system_->analysis().time_scale, j / n() + 1);
  double largest_x = 0.0;
  for (int j = 0; j < n(); ++j) largest_x = std::max(largest_x, std::fabs(x[j]) / problem_.units()[j]);
  for (int i = 0; i < rows; ++i) {
    double largest = 0.0;
    for (int j = 0; j < size; ++j) largest = std::max(largest, std::fabs(array.M(i, j) *= unit[index(j)]));
    for (int j = 0; j < n(); ++j) largest = std::max(largest, std::fabs(array.N(i, j) * problem_.units()[j]));
    if (largest == 0.0) continue;
    for (int j = 0; j < size; ++j) array.M(i, j) /= largest;
    array.g[index(i)] /= largest;
  }
  const std::vector<double> y = least_squares(array.M, array.g, rounding * singular_values(array.M).front());
  const double largest = std::max(largest_x, max_abs(y.data(), size));
  multiply(-1.0, Op::plain, array.M, y.data(), 1.0, array.g.data());
  if (!(max_abs(array.g.data(), rows) <= consistent_residual * largest + cancelled))
    throw_inconsistent_jet(t, highest);
  double factorial = 1.0;
  for (int k = 1; k <= highest + 1; ++k) {
    factorial *= k;
    for (int i = 0; i < n(); ++i) {
      const std::size_t j = index((k - 1) * n() + i);
      jet.column(k)[i] = unit[j] * y[j] / factorial;
    }
  }
  jet.set_order(level + 1);
  return jet;
}

DerivativeArray LinearModel::derivative_array(const Jet& jet, int level) {
  DerivativeArray array = derivative_array(jet.t, level);
  if (jet.n > 0) move_to_jet(jet, array);
  return array;
}

StrangenessFreeEquations LinearModel::strangeness_free(const Jet& jet) {
  const Projectors found = projectors(jet.t);
  return strangeness_free_equations(derivative_array(jet, system_->analysis().values.mu), found);
}

}  // namespace sfdae::core
