// A mechanical system with constraints, with its strangeness-free system.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_model.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "multibody/multibody_consistency.h"
#include "multibody/multibody_impact.h"
#include "multibody/multibody_supplied_lines.h"
#include "problem/failure.h"
#include "problem/supplied_line.h"

namespace sfdae::core {

namespace {

// The largest change of positions and velocities; rounding errors of the largest of them are ignored, whatever the
// tolerances.
ValueChange change_of_motion(const MultibodySizes& sizes, const std::vector<double>& tolerances,
                             const std::vector<double>& given, const std::vector<double>& x) {
  constexpr double rounding = 1e-13;
  const int nq = sizes.positions, nv = sizes.velocities;
  const double of_positions = rounding * max_abs(x.data(), nq), of_velocities = rounding * max_abs(x.data() + nq, nv);
  std::vector<double> changes(index(nq + nv));
  for (int i = 0; i < nq + nv; ++i) {
    const double change = x[index(i)] - given[index(i)];
    if (std::fabs(change) > (i < nq ? of_positions : of_velocities)) changes[index(i)] = change;
  }
  return largest_change(given.data(), changes.data(), tolerances, nq + nv);
}

}  // namespace

void report_change_of_motion(const MultibodySizes& sizes, const GivenMotion& given, ConsistentPoint& found) {
  double sum = 0.0;
  for (std::size_t i = 0; i < index(sizes.positions + sizes.velocities); ++i)
    sum += std::pow(found.x[i] - given.x[i], 2);
  found.change.residual_before = std::sqrt(sum);
  report_change(given.request, given.t, given.x, found.x, found.change);
  if (given.request.reports_changes())
    found.value_change = change_of_motion(sizes, given.request.tolerances, given.x, found.x);
  if (given.request.kind == InitialValues::accept) found.x = given.x;
}

void MultibodyModel::add_equations(WordHash& hash) {
  const MultibodySizes& sizes = problem_->sizes();
  const int numbers[] = {sizes.positions, sizes.velocities, sizes.holonomic, sizes.nonholonomic,
                         static_cast<int>(coordinates_)};
  hash.add_all(numbers);
  if (recorded_ == nullptr) return;
  if (!equations_) {
    equations_.emplace();
    core::add_equations(recorded_->first_order_problem()->evaluator().record(), *equations_);
  }
  hash.add(equations_->value());
}

void MultibodyModel::analyze(const PointOfInterest& point, const ModelOptions& options,
                             std::vector<RankDecision>& decisions) {
  forget_system();
  decisions.clear();
  const MultibodySizes& sizes = problem_->sizes();
  problem_->check_rates(point.t, point.x);
  const ConsistencyRequest request = options.request_at(point.x);
  MultibodyConsistency consistency(*problem_, point.t, request, options.ignore_inconsistency);
  const std::vector<double> q = consistency.positions(point.x);
  const MultibodyRanks ranks = consistency.ranks(q, options.analysis.rank_tol, decisions);
  const std::vector<double> v = consistency.velocities(q, point.x + sizes.positions, ranks.velocities);
  IndexAnalysis analysis;
  analysis.values = characteristic_values(sizes, ranks);
  if (analysis.values.mu > options.analysis.max_index)
    throw Failure(SFDAE_INDEX_TOO_HIGH,
                  format("the strangeness index of these constraints is %d, but max_index is %d.", analysis.values.mu,
                         options.analysis.max_index));
  analysis.t = point.t;
  analysis.v_hat = sizes.constraints() - ranks.velocities;
  analysis.rank_E = sizes.positions + consistency.rank_of_mass();
  analysis.by_precedent = analysis.values == options.precedent.values && analysis.rank_E == options.precedent.rank_E;
  system_ = std::make_unique<MultibodySystem>(*problem_, settings(ranks, options.analysis), std::move(analysis),
                                              q.data(), v.data());
}

void MultibodyModel::demand_derivatives(const PointOfInterest& point, const ModelOptions&) {
  // If no consistent values were found, g_q may come from a formula that is valid on the constraints only: it counts as
  // wrong if its error is larger than this. By judgement.
  constexpr double off_constraints = 0.3;
  if (callbacks_ == nullptr) return;
  const double* q = point.x;
  const double* v = point.x + problem_->sizes().positions;
  if (system_) {
    q = system_->accepted_point().q.data();
    v = system_->accepted_point().v.data();
  }
  core::demand_derivatives(*callbacks_, {point.t, point.toward, q, v, system_ ? least_wrong_part : off_constraints});
}

std::unique_ptr<MultibodySystem> MultibodyModel::archived_system(const ModelOptions& options, Archive& archive) {
  return std::make_unique<MultibodySystem>(*problem_, settings({}, options.analysis), archive);
}

std::unique_ptr<MultibodySystem> MultibodyModel::copy_of_system() {
  IndexAnalysis analysis = system_->analysis();
  const MultibodyPoint& point = system_->accepted_point();
  analysis.t = point.t;
  return std::make_unique<MultibodySystem>(*problem_, system_->settings(), std::move(analysis), point.q.data(),
                                           point.v.data());
}

ConsistentPoint MultibodyModel::make_consistent(MultibodySystem& system, const PointOfInterest& point,
                                                const ModelOptions& options) {
  const MultibodySizes& sizes = problem_->sizes();
  const std::vector<double> given(point.x, point.x + n());
  const ConsistencyRequest request = options.request_at(point.x);
  MultibodyConsistency consistency(*problem_, point.t, request, options.ignore_inconsistency);
  const std::vector<double> q = consistency.positions(point.x);
  const std::vector<double> v =
      consistency.velocities(q, point.x + sizes.positions, system.settings().ranks.velocities);
  demand_point(system, system.set_point(point.t, q.data(), v.data()), point.t, "Analyze the problem there.");
  const MultibodyPoint& found = system.accepted_point();
  ConsistentPoint result;
  result.t = point.t;
  result.has_contradiction = consistency.has_contradiction();
  result.x = found.q;
  result.x.insert(result.x.end(), found.v.begin(), found.v.end());
  result.x.insert(result.x.end(), found.mu.begin(), found.mu.begin() + sizes.constraints());
  keep_fixed(request, point, result.x);
  result.change.residual_after = std::max(position_residual(found), velocity_residual(found));
  report_change_of_motion(sizes, {request, point.t, given}, result);
  add_derivative(system, point.direction(), result);
  return result;
}

namespace {

// Impulses of constraints change velocities, never positions.
void demand_positions(const ConsistencyRequest& request, double t, const double* given,
                      const std::vector<double>& q) {
  for (std::size_t i = 0; i < q.size(); ++i)
    if (std::fabs(q[i] - given[i]) > request.tolerances[i])
      throw Failure(
          SFDAE_NO_CONSISTENT_VALUES,
          format("positions violate the constraints at t = %.15g: x[%d] = %.6g would have to jump by %.3g, and "
                 "impulses change velocities only. Switch where the constraints hold, or correct the "
                 "positions.",
                 t, static_cast<int>(i), given[i], q[i] - given[i]));
}

}  // namespace

Jump MultibodyModel::impact(const PointOfInterest& point, const ModelOptions& options,
                            const std::vector<double>& restitution) {
  const MultibodySizes& sizes = problem_->sizes();
  const int nq = sizes.positions, nv = sizes.velocities;
  ConsistencyRequest request = options.request_at(point.x);
  request.kind = InitialValues::nearest;
  MultibodyConsistency consistency(*problem_, point.t, request, options.ignore_inconsistency);
  const std::vector<double> q = consistency.positions(point.x);
  demand_positions(request, point.t, point.x, q);
  const std::vector<double> v_before(point.x + nq, point.x + nq + nv);
  const Impact found =
      core::impact(*problem_, {point.t, q, v_before}, system_->settings().ranks.velocities, restitution);

  Jump jump{q, Matrix(n(), system_->analysis().values.mu)};
  jump.x.insert(jump.x.end(), found.v.begin(), found.v.end());
  jump.x.resize(index(n()), 0.0);
  for (int i = 0; i < sizes.constraints(); ++i) jump.impulses(nq + nv + i, 0) = found.p[index(i)];
  if (std::any_of(restitution.begin(), restitution.end(), [](double e) { return e != 0.0; })) return jump;
  ModelOptions plain = options;
  plain.consistency = request;
  jump.x = consistent_point_beside({point.t, point.toward, jump.x.data()}, plain).x;
  return jump;
}

// Fixed components stay bit by bit. Forces of constraints follow from positions and velocities: given ones have to
// agree.
void MultibodyModel::keep_fixed(const ConsistencyRequest& request, const PointOfInterest& given,
                                std::vector<double>& x) const {
  // Relative to the largest force. Accelerations lose digits by their condition; no figures were recorded.
  constexpr double fixed_tolerance = 1e-9;
  if (request.kind != InitialValues::fixed) return;
  const std::size_t size = index(problem_->sizes().positions + problem_->sizes().velocities);
  double largest = 0.0;
  for (std::size_t i = size; i < x.size(); ++i) largest = std::max(largest, std::fabs(x[i]));
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (request.fixed[i] == 0) continue;
    if (i >= size && std::fabs(x[i] - given.x[i]) > fixed_tolerance * std::max(largest, std::fabs(given.x[i])))
      throw Failure(
          SFDAE_FIXED_VALUES,
          format("x[%d] = %.6g is fixed, but it is a force of constraints, and positions and velocities make it "
                 "%.6g at t = %.15g.",
                 static_cast<int>(i), given.x[i], x[i], given.t));
    x[i] = given.x[i];
  }
}

// The ranks are those of the constraints, with a condition in the report.
double MultibodyModel::certify() {
  throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                "the ranks of multibody systems are those of the constraints: see sfdae_get_multibody_report.");
}

ConstraintsReport MultibodyModel::constraints() const {
  const MultibodySizes& sizes = problem_->sizes();
  const MultibodyRanks& ranks = system_->settings().ranks;
  const MultibodyPoint& point = system_->accepted_point();
  return {.t = point.t,
          .holonomic = sizes.holonomic,
          .nonholonomic = sizes.nonholonomic,
          .redundant = sizes.constraints() - ranks.velocities,
          .degrees_of_freedom = sizes.velocities - ranks.velocities,
          .position_freedom = sizes.positions - ranks.positions,
          .condition = condition_of_constraints(point, system_->partition()),
          .partitions = system_->partitions(),
          .position_residual = position_residual(point),
          .velocity_residual = velocity_residual(point)};
}

}  // namespace sfdae::core
