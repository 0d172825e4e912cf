// A nonlinear problem as the API sees it; recorded equations that turn out to be linear.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "c_api/expressions.h"
#include "c_api/linear_model.h"
#include "c_api/model.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "problem/recorded_linear.h"
#include "system/nonlinear_changes.h"
#include "system/nonlinear_system.h"
#include "system/nonlinear_values.h"

namespace sfdae::core {

namespace {

PrescribedInputs inputs_of(const sfdae_nonlinear_problem& problem) {
  return {{problem.prescribed, problem.prescribed + (problem.prescribed != nullptr ? problem.num_prescribed : 0)},
          problem.prescribed_values,
          problem.user};
}

// Empty where nothing is left out of any array.
std::vector<int> differentiations_of(const sfdae_nonlinear_problem& problem) {
  if (problem.differentiations == nullptr) return {};
  std::vector<int> counts(problem.differentiations, problem.differentiations + problem.num_equations);
  const bool has_all = *std::min_element(counts.begin(), counts.end()) == max_strangeness_index;
  return has_all ? std::vector<int>() : counts;
}

class NonlinearModel final : public Model {
 public:
  explicit NonlinearModel(std::unique_ptr<NonlinearProblem> problem) : problem_(std::move(problem)) {}
  Problem& problem() override { return *problem_; }
  int m() const override { return problem_->m(); }
  int n() const override { return problem_->n(); }
  bool needs_x() const override { return true; }
  NonlinearProblem* nonlinear() override { return problem_.get(); }
  TaylorEvaluator* evaluator() override {
    auto* recorded = dynamic_cast<RecordedProblem*>(problem_.get());
    return recorded != nullptr ? &recorded->evaluator() : nullptr;
  }
  void set_differences(const DifferenceOptions&) override {}

  std::unique_ptr<DaeSystem> analyze(const PointOfInterest& point, const SolverOptions& options,
                                     std::vector<RankDecision>& decisions) override {
    if (problem_->differentiations().empty()) return analyze_with(options.analysis, point, options, decisions);
    try {
      return analyze_with(options.analysis, point, options, decisions);
    } catch (const Failure& failure) {
      if (failure.status() != SFDAE_INDEX_TOO_HIGH) throw;
    }
    return analyze_against_whole_array(point, options, decisions);
  }

  std::unique_ptr<DaeSystem> copy_of(const DaeSystem& system, const SolverOptions& options) override {
    const auto& original = static_cast<const NonlinearSystem&>(system);
    return std::make_unique<NonlinearSystem>(*problem_, options.analysis, original.analysis(), original.units(),
                                             original.jet());
  }

  Consistent consistent_values(DaeSystem& any_system, const SolverOptions& options,
                               const PointOfInterest& point) override {
    NonlinearSystem& system = static_cast<NonlinearSystem&>(any_system);
    const double t = point.t;
    Consistent result;
    result.x.assign(point.x, point.x + n());
    ConsistencyRequest request = options.consistency;
    const Tolerances& tolerances = options.integration.tolerances;
    request.set_tolerances(tolerances.rtol, tolerances.atol, point.x);
    // The jet that is known helps where it is near.
    Jet start = system.jet();
    if (start.t != t || !std::equal(point.x, point.x + n(), start.x.data())) {
      start.t = t;
      start.x.assign(point.x, point.x + n());
      start.set_order(0);
      JetSolver solver(*problem_, system.units());
      solver.set_fixed(fixed(options));
      for (int level = 0; level <= system.analysis().values.mu; ++level) solver.solve(start, level);
    }
    const ConsistentJetResult found =
        choose_consistent_jet(*problem_, system.analysis(), system.units(), request, start, result.x);
    const PointStatus status = system.set_point(found.jet);
    if (status == PointStatus::callback_error)
      throw Failure(system.callback_error().status, system.callback_error().message());
    if (status != PointStatus::ok)
      throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                    "the characteristic values known (" + describe(system.analysis().values) +
                        format(") do not hold at t = %.15g. Analyze the problem there.", t));
    system.apply_inputs();
    result.x.assign(system.jet().x.data(), system.jet().x.data() + n());
    if (request.kind == InitialValues::accept) result.x.assign(point.x, point.x + n());
    result.xdot.resize(index(n()));
    const bool exact =
        system.consistent_derivative(result.x.data(), point.toward < t ? -1.0 : 1.0, result.xdot.data());
    demand_finite_derivative(result.xdot, t);
    result.report = {sizeof(sfdae_initial_report),
                     t,
                     found.change.residual_before,
                     found.change.residual_after,
                     found.change.largest_change,
                     found.change.component,
                     exact ? 1 : 0};
    return result;
  }

  std::unique_ptr<ChangeDetector> detector(DaeSystem& system) override {
    return std::make_unique<NonlinearChanges>(static_cast<NonlinearSystem&>(system));
  }

  CheckpointTarget checkpoint_target(const AnalysisSettings& settings) override {
    return {m(), n(),
            [this, &settings](Archive& archive) {
              return std::make_unique<NonlinearSystem>(*problem_, settings, archive);
            },
            [this](DaeSystem& system) { return detector(system); }};
  }

  void count_evaluations(sfdae_statistics& statistics) const override {
    statistics.evaluations_F = problem_->evaluations();
    statistics.linearizations = problem_->linearizations();
  }

 private:
  std::unique_ptr<DaeSystem> analyze_with(const AnalysisSettings& settings, const PointOfInterest& point,
                                          const SolverOptions& options, std::vector<RankDecision>& decisions) {
    ConsistentJets jets(*problem_, point.t, point.x, fixed(options));
    Arena arena;
    IndexAnalysis analysis = analyze_index(jets, point.t, point.toward, settings, arena, decisions);
    return std::make_unique<NonlinearSystem>(*problem_, options.analysis, std::move(analysis), jets.units(),
                                             jets.jet_at(point.t, analysis.values.mu));
  }

  // How many equations are redundant only the array with all its rows tells.
  std::unique_ptr<DaeSystem> analyze_against_whole_array(const PointOfInterest& point, const SolverOptions& options,
                                                         std::vector<RankDecision>& decisions) {
    AnalysisSettings settings = options.analysis;
    const std::vector<int> counts = problem_->differentiations();
    problem_->set_differentiations({});
    try {
      settings.expected = analyze_with(options.analysis, point, options, decisions)->analysis().values;
    } catch (...) {
      problem_->set_differentiations(counts);
      throw;
    }
    problem_->set_differentiations(counts);
    try {
      return analyze_with(settings, point, options, decisions);
    } catch (const Failure& failure) {
      if (failure.status() != SFDAE_INDEX_TOO_HIGH) throw;
      throw Failure(SFDAE_INDEX_TOO_HIGH, "differentiations are too few: with all equations differentiated, " +
                                              describe(settings.expected) + format(" at t = %.15g, but ", point.t) +
                                              failure.what());
    }
  }

  static std::vector<char> fixed(const SolverOptions& options) {
    return options.consistency.kind == InitialValues::fixed ? options.consistency.fixed : std::vector<char>();
  }

  std::unique_ptr<NonlinearProblem> problem_;
};

// Recorded equations that are linear: E, A and f are read off the record.
class RecordedLinearModel final : public Model {
 public:
  RecordedLinearModel(std::shared_ptr<const Record> record, const sfdae_nonlinear_problem& problem)
      : coefficients_(std::move(record), inputs_of(problem)), model_(coefficients_.problem()) {
    model_.linear()->set_explanation([this](double t) { return coefficients_.failure(t); });
  }
  Problem& problem() override { return model_.problem(); }
  int m() const override { return model_.m(); }
  int n() const override { return model_.n(); }
  bool is_constant() const override { return model_.is_constant(); }
  LinearProblem* linear() override { return model_.linear(); }
  TaylorEvaluator* evaluator() override { return &coefficients_.evaluator(); }
  void parameters_changed() override {
    coefficients_.forget();
    model_.linear()->forget_constants();
  }
  void set_differences(const DifferenceOptions& options) override { model_.set_differences(options); }
  std::unique_ptr<DaeSystem> analyze(const PointOfInterest& point, const SolverOptions& options,
                                     std::vector<RankDecision>& decisions) override {
    return model_.analyze(point, options, decisions);
  }
  std::unique_ptr<DaeSystem> copy_of(const DaeSystem& system, const SolverOptions& options) override {
    return model_.copy_of(system, options);
  }
  Consistent consistent_values(DaeSystem& system, const SolverOptions& options,
                               const PointOfInterest& point) override {
    return model_.consistent_values(system, options, point);
  }
  std::unique_ptr<ChangeDetector> detector(DaeSystem& system) override { return model_.detector(system); }
  CheckpointTarget checkpoint_target(const AnalysisSettings& settings) override {
    return model_.checkpoint_target(settings);
  }
  void count_evaluations(sfdae_statistics& statistics) const override { model_.count_evaluations(statistics); }

 private:
  RecordedLinearCoefficients coefficients_;
  LinearModel model_;
};

}  // namespace

std::unique_ptr<Model> nonlinear_model(const sfdae_nonlinear_problem& problem) {
  const int m = problem.num_equations, n = problem.num_unknowns;
  const std::vector<int> counts = differentiations_of(problem);
  const auto model_of = [&counts](std::unique_ptr<NonlinearProblem> nonlinear) {
    nonlinear->set_differentiations(counts);
    return std::make_unique<NonlinearModel>(std::move(nonlinear));
  };
  if (problem.total_derivative != nullptr)
    return model_of(
        std::make_unique<CallbackProblem>(m, n, problem.total_derivative, problem.user, inputs_of(problem)));
  std::shared_ptr<const Record> record = problem.equations != nullptr
                                             ? record_equations(problem.equations, m, n, problem.user)
                                             : record_linear_equations(problem.linear_equations, m, n, problem.user);
  if (record->is_linear() && counts.empty()) return std::make_unique<RecordedLinearModel>(std::move(record), problem);
  return model_of(std::make_unique<RecordedProblem>(std::move(record), inputs_of(problem)));
}

}  // namespace sfdae::core
