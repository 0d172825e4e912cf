// A multibody system as the API sees it.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/multibody_model.h"

#include <algorithm>
#include <cmath>

#include "c_api/model.h"
#include "c_api/multibody_recording.h"
#include "linalg/index.h"
#include "multibody/multibody_changes.h"
#include "multibody/multibody_consistency.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

class MultibodyModel final : public Model {
 public:
  MultibodyModel(std::unique_ptr<MultibodyProblem> problem, Coordinates coordinates)
      : problem_(std::move(problem)), coordinates_(coordinates) {}
  Problem& problem() override { return *problem_; }
  int m() const override { return n(); }
  int n() const override { return problem_->sizes().unknowns(); }
  bool needs_x() const override { return true; }
  MultibodyProblem* multibody() override { return problem_.get(); }
  TaylorEvaluator* evaluator() override { return problem_->evaluator(); }
  void parameters_changed() override { problem_->parameters_changed(); }
  void set_differences(const DifferenceOptions&) override {}

  std::unique_ptr<DaeSystem> analyze(const PointOfInterest& point, const SolverOptions& options,
                                     std::vector<RankDecision>& decisions) override {
    decisions.clear();
    const MultibodySizes& sizes = problem_->sizes();
    problem_->check_rates(point.t, point.x);
    ConsistencyRequest request = options.consistency;
    const Tolerances& tolerances = options.integration.tolerances;
    request.set_tolerances(tolerances.rtol, tolerances.atol, point.x);
    MultibodyConsistency consistency(*problem_, point.t, request, options.integration.ignore_inconsistency);
    const std::vector<double> q = consistency.positions(point.x);
    const MultibodyRanks ranks = consistency.ranks(q, options.analysis.rank_tol, decisions);
    const std::vector<double> v = consistency.velocities(q, point.x + sizes.positions, ranks.velocities);
    IndexAnalysis analysis;
    analysis.values = characteristic_values(sizes, ranks);
    if (analysis.values.mu > options.analysis.max_index)
      throw Failure(SFDAE_INDEX_TOO_HIGH,
                    format("the strangeness index of these constraints is %d, but max_index is %d.",
                           analysis.values.mu, options.analysis.max_index));
    analysis.t = point.t;
    analysis.v_hat = sizes.constraints() - ranks.velocities;
    analysis.rank_E = sizes.positions + consistency.rank_of_mass();
    return std::make_unique<MultibodySystem>(*problem_, traits(ranks, options.analysis), std::move(analysis),
                                             q.data(), v.data());
  }

  std::unique_ptr<DaeSystem> copy_of(const DaeSystem& system, const SolverOptions&) override {
    const auto& original = static_cast<const MultibodySystem&>(system);
    IndexAnalysis analysis = original.analysis();
    const MultibodyPoint& point = original.accepted_point();
    analysis.t = point.t;
    return std::make_unique<MultibodySystem>(*problem_, original.traits(), analysis, point.q.data(), point.v.data());
  }

  Consistent consistent_values(DaeSystem& any_system, const SolverOptions& options,
                               const PointOfInterest& point) override {
    auto& system = static_cast<MultibodySystem&>(any_system);
    const MultibodySizes& sizes = problem_->sizes();
    const std::size_t n = index(sizes.unknowns());
    const std::vector<double> given(point.x, point.x + n);
    ConsistencyRequest request = options.consistency;
    const Tolerances& tolerances = options.integration.tolerances;
    request.set_tolerances(tolerances.rtol, tolerances.atol, point.x);
    MultibodyConsistency consistency(*problem_, point.t, request, options.integration.ignore_inconsistency);
    const std::vector<double> q = consistency.positions(point.x);
    const std::vector<double> v =
        consistency.velocities(q, point.x + sizes.positions, system.traits().ranks.velocities);
    set_point(system, point.t, q, v);
    const MultibodyPoint& found = system.accepted_point();
    Consistent result;
    result.contradiction = consistency.has_contradiction();
    result.x = found.q;
    result.x.insert(result.x.end(), found.v.begin(), found.v.end());
    result.x.insert(result.x.end(), found.mu.begin(), found.mu.begin() + sizes.constraints());
    keep_fixed(request, point.t, given, result.x);
    ConsistencyResult change;
    const std::size_t size = index(system.leading_size());
    double sum = 0.0;
    for (std::size_t i = 0; i < size; ++i) sum += std::pow(result.x[i] - given[i], 2);
    change.residual_before = std::sqrt(sum);
    change.residual_after = std::max(system.position_residual(), system.velocity_residual());
    report_change(request, point.t, given, result.x, change);
    if (request.kind == InitialValues::accept) result.x = given;
    result.xdot.resize(n);
    const bool exact =
        system.consistent_derivative(result.x.data(), point.toward < point.t ? -1.0 : 1.0, result.xdot.data());
    demand_finite_derivative(result.xdot, point.t);
    result.report = {sizeof(sfdae_initial_report), point.t,          change.residual_before, change.residual_after,
                     change.largest_change,        change.component, exact ? 1 : 0};
    return result;
  }

  std::unique_ptr<ChangeDetector> detector(DaeSystem& system) override {
    return std::make_unique<MultibodyChanges>(static_cast<MultibodySystem&>(system));
  }

  CheckpointTarget checkpoint_target(const AnalysisSettings& settings) override {
    return {n(), n(),
            [this, settings](Archive& archive) {
              return std::make_unique<MultibodySystem>(*problem_, traits({}, settings), archive);
            },
            [this](DaeSystem& system) { return detector(system); }};
  }

  void count_evaluations(sfdae_statistics& statistics) const override {
    statistics.evaluations_F = problem_->evaluations();
    statistics.linearizations = problem_->linearizations();
  }

 private:
  MultibodySystem::Traits traits(const MultibodyRanks& ranks, const AnalysisSettings& settings) const {
    return {ranks, coordinates_, settings.rank_tol};
  }

  static void set_point(MultibodySystem& system, double t, const std::vector<double>& q,
                        const std::vector<double>& v) {
    const PointStatus status = system.set_point(t, q.data(), v.data());
    if (status == PointStatus::callback_error)
      throw Failure(system.callback_error().status, system.callback_error().message());
    if (status != PointStatus::ok)
      throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                    "the characteristic values known (" + describe(system.analysis().values) +
                        format(") do not hold at t = %.15g. Analyze the problem there.", t));
  }

  // Components that are fixed stay to the last bit. Forces of constraints follow from positions and velocities: those
  // given have to fit.
  void keep_fixed(const ConsistencyRequest& request, double t, const std::vector<double>& given,
                  std::vector<double>& x) const {
    constexpr double fixed_tolerance = 1e-9;
    if (request.kind != InitialValues::fixed) return;
    const std::size_t size = index(problem_->sizes().positions + problem_->sizes().velocities);
    double largest = 0.0;
    for (std::size_t i = size; i < x.size(); ++i) largest = std::max(largest, std::fabs(x[i]));
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (request.fixed[i] == 0) continue;
      if (i >= size && std::fabs(x[i] - given[i]) > fixed_tolerance * std::max(largest, std::fabs(given[i])))
        throw Failure(
            SFDAE_FIXED_VALUES,
            format("x[%d] = %.6g is fixed, but it is a force of constraints, and positions and velocities make it "
                   "%.6g at t = %.15g.",
                   static_cast<int>(i), given[i], x[i], t));
      x[i] = given[i];
    }
  }

  std::unique_ptr<MultibodyProblem> problem_;
  Coordinates coordinates_;
};

}  // namespace

std::unique_ptr<Model> multibody_model(const sfdae_multibody_problem& problem) {
  return std::make_unique<MultibodyModel>(
      multibody_problem(problem),
      problem.coordinates == SFDAE_COORDINATES_PERMUTATION ? Coordinates::permutation : Coordinates::orthogonal);
}

sfdae_multibody_report report_of(const MultibodySystem& system) {
  const MultibodySizes& sizes = system.sizes();
  const MultibodyRanks& ranks = system.traits().ranks;
  sfdae_multibody_report report{};
  report.size = sizeof report;
  report.t = system.accepted_point().t;
  report.holonomic = sizes.holonomic;
  report.nonholonomic = sizes.nonholonomic;
  report.redundant = sizes.constraints() - ranks.velocities;
  report.degrees_of_freedom = sizes.velocities - ranks.velocities;
  report.position_freedom = sizes.positions - ranks.positions;
  report.condition = system.condition();
  report.partitions = system.partitions();
  report.position_residual = system.position_residual();
  report.velocity_residual = system.velocity_residual();
  return report;
}

}  // namespace sfdae::core
