// A nonlinear problem with its system.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/nonlinear_model.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "linalg/index.h"
#include "problem/failure.h"
#include "problem/total_derivative_lines.h"
#include "starts/consistent_jets.h"
#include "starts/jet_solver.h"
#include "starts/jet_theory.h"
#include "starts/nonlinear_jump.h"
#include "starts/nonlinear_values.h"
#include "starts/structural_contradiction.h"
#include "system/jet_coefficients.h"

namespace sfdae::core {

namespace {

std::vector<char> fixed_components(const ModelOptions& options) {
  return options.consistency.kind == InitialValues::fixed ? options.consistency.fixed : std::vector<char>();
}

// True if no other starting value will help.
bool is_final(const Failure& failure) {
  const int status = failure.status();
  return ends_everything(status) || status == SFDAE_ORDER_MISSING;
}

Jet guessed_jet(const PointOfInterest& point, int n) {
  Jet jet;
  jet.t = point.t;
  jet.n = n;
  jet.x.assign(point.x, point.x + n);
  if (point.xdot == nullptr) return jet;
  jet.set_order(1);
  std::copy_n(point.xdot, n, jet.column(1));
  return jet;
}

// Uses all rows of the derivative array during its lifetime.
class WholeArray {
 public:
  explicit WholeArray(NonlinearProblem& problem) : problem_(problem), counts_(problem.differentiations()) {
    problem_.set_differentiations({});
  }
  WholeArray(const WholeArray&) = delete;
  WholeArray& operator=(const WholeArray&) = delete;
  ~WholeArray() { problem_.set_differentiations(std::move(counts_)); }

 private:
  NonlinearProblem& problem_;
  std::vector<int> counts_;
};

}  // namespace

void NonlinearModel::analyze(const PointOfInterest& point, const ModelOptions& options,
                             std::vector<RankDecision>& decisions) {
  forget_system();
  guess_.clear();
  problem_->follow_structure(false);
  if (options.structure != StructureUse::off && !options.analysis.by_svd &&
      analyzed_by_structure(point, options, decisions))
    return;
  try {
    system_ = analyzed(options.analysis_by_precedent(), point, options, decisions);
    demand_agreement();
    return;
  } catch (const Failure& failure) {
    if (problem_->differentiations().empty() || failure.status() != SFDAE_INDEX_TOO_HIGH) throw;
  }
  system_ = analyzed_against_whole_array(point, options, decisions);
}

// Leaves out the rows that the structural analysis does not need, if the system Jacobian is nonsingular at the point
// found. If anything fails, the full derivative array decides.
bool NonlinearModel::analyzed_by_structure(const PointOfInterest& point, const ModelOptions& options,
                                           std::vector<RankDecision>& decisions) {
  const Structure* const structure = problem_->counts_are_given() ? nullptr : problem_->structure();
  if (structure == nullptr || !structure->offsets.leaves_out_rows()) return false;
  problem_->follow_structure(true);
  try {
    const bool keeps = options.request_at(point.x).differentiated_stay();
    system_ = analyzed_near(options.analysis_by_precedent(), point, options, keeps, decisions);
    if (certifies_structure() && moves_least(point, options)) {
      demand_agreement();
      return true;
    }
  } catch (const Failure& failure) {
    if (is_final(failure)) {
      give_up_structure();
      throw;
    }
  } catch (...) {
    give_up_structure();
    throw;
  }
  give_up_structure();
  decisions.clear();
  return false;
}

// Throws Failure if the derivative array and the structural analysis disagree.
void NonlinearModel::demand_agreement() {
  const std::string contradiction = contradiction_of_structure(
      *problem_, system_->accepted_jet(), system_->analysis().values, system_->settings().rank_tol);
  if (contradiction.empty()) return;
  forget_system();
  throw Failure(SFDAE_RANK_UNCLEAR, contradiction);
}

void NonlinearModel::give_up_structure() {
  forget_system();
  guess_.clear();
  problem_->follow_structure(false);
}

// The consistent jet that is found depends on the rows. If differential variables move, the full derivative array tells
// whether they have to move that far.
double NonlinearModel::largest_move(const PointOfInterest& point, const ModelOptions& options) const {
  const std::vector<double> sizes = options.request_at(point.x).sizes();
  const Signature& signature = problem_->structure()->signature;
  const Jet& jet = system_->accepted_jet();
  double largest = 0.0;
  for (int i = 0; i < signature.size(); ++i)
    for (const Signature::Entry& entry : signature.row(i)) {
      const std::size_t j = index(entry.unknown);
      if (entry.order > 0) largest = std::max(largest, std::fabs(jet.x[j] - point.x[j]) / sizes[j]);
    }
  return largest;
}

bool NonlinearModel::moves_least(const PointOfInterest& point, const ModelOptions& options) {
  // A negligible move in tolerances, and a relative margin. Chosen, not measured.
  constexpr double negligible = 1e-6, margin = 1.01;
  const double move = largest_move(point, options);
  if (move <= negligible) return true;
  std::shared_ptr<NonlinearSystem> followed = std::move(system_);
  const std::vector<double> guess = guess_;
  problem_->follow_structure(false);
  std::vector<RankDecision> ignored;
  try {
    system_ = analyzed(options.analysis_by_precedent(), point, options, ignored);
  } catch (const Failure& failure) {
    if (is_final(failure)) throw;
  }
  const bool is_least = !system_ || move <= margin * largest_move(point, options);
  system_ = std::move(followed);
  guess_ = guess;
  problem_->follow_structure(true);
  return is_least;
}

bool NonlinearModel::certifies_structure() {
  const Jet& jet = system_->accepted_jet();
  Certificate certificate;
  return certify_structure(*problem_->structure(), *problem_->structure_evaluator(), {jet.t, jet.x.data()},
                           system_->settings().rank_tol, certificate) &&
         certificate.is_given();
}

std::unique_ptr<NonlinearSystem> NonlinearModel::analyzed_near(const AnalysisSettings& settings,
                                                               const PointOfInterest& point,
                                                               const ModelOptions& options, bool keeps,
                                                               std::vector<RankDecision>& decisions) {
  ConsistentJets jets(*problem_, point.t, point.x, fixed_components(options));
  if (keeps) jets.keep_differentiated(options.request_at(point.x).sizes());
  if (point.xdot != nullptr) jets.guess_derivative(point.xdot);
  Arena arena;
  IndexAnalysis analysis = analyze_index(jets, point.t, point.toward, settings, arena, decisions);
  if (keeps && point.xdot == nullptr) guess_.assign(point.x, point.x + n());
  return std::make_unique<NonlinearSystem>(*problem_, options.analysis, std::move(analysis), jets.units(),
                                           jets.jet_at(point.t, analysis.values.mu));
}

std::unique_ptr<NonlinearSystem> NonlinearModel::analyzed(const AnalysisSettings& settings,
                                                          const PointOfInterest& point, const ModelOptions& options,
                                                          std::vector<RankDecision>& decisions) {
  if (options.request_at(point.x).differentiated_stay()) {
    try {
      return analyzed_near(settings, point, options, true, decisions);
    } catch (const Failure& failure) {
      if (is_final(failure)) throw;
    }
  }
  // If the differential variables are far off, too, the smallest changes lead more safely to the constraints.
  return analyzed_near(settings, point, options, false, decisions);
}

// Only the full derivative array shows how many equations are redundant.
std::unique_ptr<NonlinearSystem> NonlinearModel::analyzed_against_whole_array(const PointOfInterest& point,
                                                                              const ModelOptions& options,
                                                                              std::vector<RankDecision>& decisions) {
  AnalysisSettings settings = options.analysis;
  {
    const WholeArray whole(*problem_);
    settings.expected = analyzed(options.analysis, point, options, decisions)->analysis().values;
  }
  try {
    return analyzed(settings, point, options, decisions);
  } catch (const Failure& failure) {
    if (failure.status() != SFDAE_INDEX_TOO_HIGH) throw;
    throw Failure(SFDAE_INDEX_TOO_HIGH, "differentiations are too few: with all equations differentiated, " +
                                            describe(settings.expected) + format(" at t = %.15g, but ", point.t) +
                                            failure.what());
  }
}

bool NonlinearModel::fulfils_equations(const PointOfInterest& point) {
  try {
    core::jet_through(*problem_, {}, guessed_jet(point, n()), 0);
    return true;
  } catch (const Failure& failure) {
    if (is_final(failure)) throw;
    return false;
  }
}

// Checks at the jet of the analysis; without one there is no point to check.
void NonlinearModel::demand_derivatives(const PointOfInterest& point, const ModelOptions& options) {
  if (system_) demand_derivatives_along(system_->accepted_jet(), point, options);
}

void NonlinearModel::demand_derivatives_along(const Jet& jet, const PointOfInterest& point, const ModelOptions&) {
  if (callback_ == nullptr) return;
  std::vector<double> derivatives(jet.x);
  double factorial = 1.0;
  for (int k = 1; k <= jet.order; ++k) {
    factorial *= k;
    for (int i = 0; i < jet.n; ++i) derivatives[index(k * jet.n + i)] *= factorial;
  }
  demand_total_derivatives(*callback_, jet.t, point.toward, derivatives.data(), jet.order - 1);
}

std::unique_ptr<NonlinearSystem> NonlinearModel::archived_system(const ModelOptions& options, Archive& archive) {
  replaced_follows_structure_ = problem_->follows_structure();
  try {
    return std::make_unique<NonlinearSystem>(*problem_, options.analysis, archive);
  } catch (...) {
    problem_->follow_structure(replaced_follows_structure_);
    throw;
  }
}

void NonlinearModel::undo_restore() {
  ModelOf<NonlinearSystem>::undo_restore();
  problem_->follow_structure(replaced_follows_structure_);
}

double NonlinearModel::certify() {
  JetCoefficients source(*problem_, system_->jet(), {});
  Arena arena;
  return certified_distance(source, system_->jet().t, system_->analysis(), system_->settings(), arena);
}

std::unique_ptr<NonlinearSystem> NonlinearModel::copy_of_system() {
  return std::make_unique<NonlinearSystem>(*problem_, system_->settings(), system_->analysis(), system_->units(),
                                           system_->jet());
}

namespace {

// Starting jets of the search for consistent values, near the guess.
std::vector<std::function<Jet()>> starts(NonlinearProblem& problem, NonlinearSystem& system,
                                         const PointOfInterest& point, const ConsistencyRequest& request) {
  const int n = problem.n();
  const Jet& known = system.jet();
  const bool is_known = known.t == point.t && point.xdot == nullptr;
  // The known jet helps if it is near.
  if (is_known && std::equal(point.x, point.x + n, known.x.data())) return {[&known] { return known; }};
  const auto solved = [&problem, &system, point, n](const ConsistencyRequest& as_asked) {
    Jet jet = guessed_jet(point, n);
    JetSolver solver(problem, system.units());
    prepare(solver, as_asked);
    for (int level = 0; level <= system.analysis().values.mu; ++level) solver.solve(jet, level);
    return jet;
  };
  std::vector<std::function<Jet()>> list = {[solved, request] { return solved(request); }};
  if (!request.differentiated_stay()) return list;
  ConsistencyRequest plain = request;
  plain.keeps_differentiated = false;
  list.push_back([solved, plain] { return solved(plain); });
  if (is_known) list.push_back([&known] { return known; });
  return list;
}

// The result of the first start that leads to consistent values; if none does, throws the failure of the last one.
ConsistentJetResult choose_from_starts(NonlinearProblem& problem, NonlinearSystem& system,
                                       const PointOfInterest& point, const ConsistencyRequest& request) {
  const std::vector<double> given(point.x, point.x + problem.n());
  const auto list = starts(problem, system, point, request);
  const double rank_tol = system.settings().rank_tol;
  for (std::size_t k = 0; k + 1 < list.size(); ++k) {
    try {
      return choose_consistent_jet(problem, system.analysis(), system.units(), request, {given, list[k](), rank_tol});
    } catch (const Failure& failure) {
      if (is_final(failure)) throw;
    }
  }
  return choose_consistent_jet(problem, system.analysis(), system.units(), request, {given, list.back()(), rank_tol});
}

// The result from the jet that the analysis has found near the same values; none if it moves differential variables, as
// another start may find a nearer point.
std::optional<ConsistentJetResult> choose_from_analysis(NonlinearProblem& problem, NonlinearSystem& system,
                                                        const PointOfInterest& point,
                                                        const ConsistencyRequest& request) {
  const std::vector<double> given(point.x, point.x + problem.n());
  try {
    ConsistentJetResult found = choose_consistent_jet(problem, system.analysis(), system.units(), request,
                                                      {given, system.jet(), system.settings().rank_tol});
    if (!found.value_change.is_beyond_tolerances()) return found;
  } catch (const Failure& failure) {
    if (is_final(failure)) throw;
  }
  return std::nullopt;
}

// Sums of changes keep fixed components only up to roundoff, and a search that ended early may not have reached them.
// Prescribed components have the values of the user's function.
void restore_fixed(const NonlinearProblem& problem, const ConsistencyRequest& request, const PointOfInterest& point,
                   const Units& units, std::vector<double>& x) {
  // Relative to a component or its unit: far above roundoff, far below given accuracy. Chosen, not measured.
  constexpr double rounding = 1e-10;
  if (request.kind != InitialValues::fixed) return;
  std::vector<char> fixed = request.fixed;
  for (int j : problem.prescribed()) fixed[index(j)] = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (fixed[i] == 0) continue;
    const double allowed = rounding * std::max(std::fabs(point.x[i]), units[static_cast<int>(i)]);
    if (std::fabs(x[i] - point.x[i]) > allowed)
      throw Failure(
          SFDAE_NO_CONSISTENT_VALUES,
          format("no consistent values were found near the guess at t = %.15g that leave x[%d] = %.6g as it "
                 "is. Give a better guess, or fix fewer components.",
                 point.t, static_cast<int>(i), point.x[i]));
    x[i] = point.x[i];
  }
}

}  // namespace

ConsistentPoint NonlinearModel::make_consistent(NonlinearSystem& system, const PointOfInterest& point,
                                                const ModelOptions& options) {
  ConsistentPoint result;
  result.t = point.t;
  result.x.assign(point.x, point.x + n());
  const ConsistencyRequest request = options.request_at(point.x);
  const bool may_trust = request.differentiated_stay();
  const ConsistencyRequest first = may_trust ? request.trusting_digits(point.x) : request;
  const bool is_analyzed = may_trust && point.xdot == nullptr && system.jet().t == point.t &&
                           std::equal(guess_.begin(), guess_.end(), point.x, point.x + n());
  std::optional<ConsistentJetResult> near;
  if (is_analyzed) near = choose_from_analysis(*problem_, system, point, first);
  ConsistentJetResult found = near ? std::move(*near) : choose_from_starts(*problem_, system, point, first);
  if (may_trust && found.value_change.is_beyond_tolerances())
    found = choose_from_starts(*problem_, system, point, request);
  result.change = found.change;
  if (request.reports_changes()) result.value_change = found.value_change;
  system.complete(found.jet);
  demand_point(system, system.set_point(found.jet), point.t, "Analyze the problem there.");
  system.apply_inputs();
  if (request.kind != InitialValues::accept) result.x.assign(system.jet().x.data(), system.jet().x.data() + n());
  restore_fixed(*problem_, request, point, system.units(), result.x);
  add_derivative(system, point.direction(), result);
  return result;
}

Jump NonlinearModel::jump(const PointOfInterest& point, const ModelOptions& options) {
  const std::unique_ptr<NonlinearSystem> copy = consistent_copy(point, options);
  Jet jet = copy->jet();
  std::vector<double> before(point.x, point.x + n());
  Jump jump = find_jump(*problem_, {copy->analysis(), copy->units(), copy->settings().rank_tol}, before, jet);
  last_jump_ = {std::move(before), std::move(jet)};
  return jump;
}

bool NonlinearModel::differentiate_jump(const MovingJump& moving, const ModelOptions& options, View after) {
  if (recorded_ == nullptr || recorded_->source() != nullptr || !problem_->prescribed().empty()) return false;
  std::vector<int> parameters = moving.parameters;
  while (!parameters.empty() && parameters.back() < 0) parameters.pop_back();
  if (!jump_derivatives_ || jump_derivatives_->parameters() != parameters)
    jump_derivatives_ = std::make_unique<JumpDerivatives>(*recorded_, std::move(parameters));
  const NonlinearSystem& system = *system_;
  return jump_derivatives_->find({system.analysis(), system.units(), system.settings().rank_tol},
                                 jet_after(moving, options), moving, after);
}

// A consistent copy that keeps the differential variables; the system of an integration is not changed.
std::unique_ptr<NonlinearSystem> NonlinearModel::consistent_copy(const PointOfInterest& point,
                                                                 const ModelOptions& options) {
  std::unique_ptr<NonlinearSystem> copy = copy_of_system();
  ModelOptions plain = options;
  plain.consistency = {};
  plain.consistency.keeps_differentiated = true;
  make_consistent(*copy, point, plain);
  return copy;
}

// A jet with the values after a jump. For linear equations it is unique.
Jet NonlinearModel::jet_after(const MovingJump& moving, const ModelOptions& options) {
  const bool is_last = last_jump_.jet.t == moving.t && last_jump_.before.size() == index(n()) &&
                       std::equal(last_jump_.before.begin(), last_jump_.before.end(), moving.before);
  if (is_last) return last_jump_.jet;
  if (!recorded_->evaluator().record().is_linear())
    return consistent_copy({moving.t, moving.toward, moving.after}, options)->jet();
  Jet jet;
  jet.t = moving.t;
  jet.n = n();
  jet.x.assign(moving.after, moving.after + n());
  jet.set_order(system_->jet().order);
  JetSolver(*problem_, system_->units()).solve(jet, system_->analysis().values.mu);
  return jet;
}

}  // namespace sfdae::core
