// SPDX-License-Identifier: BSD-3-Clause
#include "solver/solver.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <new>
#include <random>
#include <stdexcept>
#include <utility>

#include "integrate/checkpoint_identity.h"
#include "integrate/difference_check.h"
#include "integrate/integration_results.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "solver/warnings.h"

namespace sfdae::core {

namespace {

// True for failures of an analysis that wrong derivatives may cause.
bool may_be_of_derivatives(int status) { return status <= SFDAE_INDEX_TOO_HIGH && status > SFDAE_MAX_STEPS; }

// True for failures of an analysis that another initial guess may avoid.
bool may_be_of_guess(int status) {
  return status == SFDAE_RANK_UNCLEAR || status == SFDAE_INDEX_TOO_HIGH || status == SFDAE_NO_CONSISTENT_VALUES ||
         status == SFDAE_NOT_FINITE || status == SFDAE_SINGULAR;
}

void demand_times(double t, double toward) {
  if (!std::isfinite(t) || !std::isfinite(toward) || t == toward)
    refuse_argument(format("t = %g, toward = %g: must be finite and different.", t, toward));
}

// x and xdot may be null if they are not required.
void demand_point(const PointOfInterest& point, int n) {
  demand_times(point.t, point.toward);
  if (point.x != nullptr && !all_finite(point.x, index(n))) refuse_argument("x contains NaN or Inf.");
  if (point.xdot != nullptr && !all_finite(point.xdot, index(n)))
    refuse_argument("xdot, which is a guess, contains NaN or Inf.");
}

void demand_jump(const Solver& solver, const PointOfInterest& before) {
  const double t = before.t;
  demand_times(t, before.toward);
  if (!all_finite(before.x, index(solver.model.n()))) refuse_argument("before contains NaN or Inf.");
  const auto& stop = solver.options.integration.stop_time;
  if (stop && (*stop - t) * (before.toward - t) <= 0.0)
    refuse_argument(format("t = %.15g lies at or beyond stop_time = %.15g.", t, *stop));
}

InitialReport report_of(const ConsistentPoint& point) {
  return {point.t,
          point.change.residual_before,
          point.change.residual_after,
          point.change.largest_change,
          point.change.component,
          point.derivative_exact};
}

void write(const ConsistentPoint& found, double* x, double* xdot) {
  std::copy(found.x.begin(), found.x.end(), x);
  if (xdot != nullptr) std::copy(found.xdot.begin(), found.xdot.end(), xdot);
}

void analyze_model(Solver& solver, const PointOfInterest& point) {
  solver.decisions = {};
  std::vector<RankDecision> decisions;
  try {
    solver.model.analyze(point, solver.options.model, decisions);
  } catch (...) {
    solver.decisions = KeptDecisions(decisions);
    throw;
  }
  solver.decisions = KeptDecisions(decisions);
}

// An analysis with wrong derivatives is discarded.
void demand_derivatives(Solver& solver, const PointOfInterest& point) {
  try {
    solver.model.demand_derivatives(point, solver.options.model);
  } catch (...) {
    solver.forget_analysis();
    throw;
  }
}

constexpr const char* no_checkpoint = "this is not a checkpoint of this version, or it is damaged.";
constexpr const char* no_checkpoints = "checkpoints cannot hold the steps that are kept for the adjoint.";

CheckpointIdentity identity_of_integration(const Solver& solver) {
  return identity_of(solver.model, solver.options.model, solver.integration->chosen_method());
}

// A checkpoint begins with its identity, and with the regularization of its equations.
struct CheckpointStart {
  Regularization regularization;
  std::size_t length;  // in doubles
};
CheckpointStart read_start(const Solver& solver, const SavedCheckpoint& saved) {
  Archive archive = Archive::reader(saved.values, saved.length);
  CheckpointStart start;
  try {
    identity_of(solver.model, solver.options.model, solver.options.integration.method).demand_same(archive);
    archive_regularization(archive, start.regularization);
  } catch (const DamagedArchive&) {
    refuse_argument(no_checkpoint);
  }
  start.length = archive.size();
  return start;
}
void archive_start(const Solver& solver, Archive& archive) {
  Regularization regularization;
  if (solver.regularized) regularization = solver.regularized->parts();
  identity_of_integration(solver).write(archive);
  archive_regularization(archive, regularization);
}
std::size_t length_of_start(const Solver& solver) {
  Archive counter = Archive::counter();
  archive_start(solver, counter);
  return counter.size();
}

void use_tolerances(Model& model, const Tolerances& tolerances) {
  TaylorEvaluator* const evaluator = model.evaluator();
  if (evaluator != nullptr && tolerances.rtol.size() > 0)
    evaluator->set_movement({tolerances.rtol.different(), tolerances.atol.different()});
}

using Evaluators = std::vector<const TaylorEvaluator*>;

}  // namespace

Solver::Solver(std::unique_ptr<FormulatedModel> its_model, SolverOptions its_options)
    : owned_model(std::move(its_model)), model(*owned_model), options(std::move(its_options)) {
  const Evaluators evaluators = model.evaluator() != nullptr ? model.evaluators_of_inputs() : Evaluators();
  breakpoints.emplace(evaluators);
  inputs.emplace(evaluators);
  find_conditions();
  use_breakpoints(options);
  use_tolerances(model, options.integration.tolerances);
}

void Solver::find_conditions() {
  const std::function<void()> branches_changed = [this] {
    model.parameters_changed();
    if (integration) integration->parameters_changed();
  };
  CallbackProblem* const callback = model.nonlinear() != nullptr ? model.nonlinear()->callback() : nullptr;
  if (callback != nullptr && callback->conditions() != nullptr) {
    const auto evaluate = [callback](double t, const double* jet, double* F) {
      return callback->call(t, 0, jet, {F}).status == SFDAE_OK;
    };
    conditions.emplace(callback->conditions()->evaluator(), branches_changed,
                       HeldConditions::SuppliedResiduals{model.m(), evaluate});
    return;
  }
  const auto switches = [](const TaylorEvaluator* evaluator) { return contains_switches(evaluator->record()); };
  const auto formulas = model.multibody() != nullptr ? model.evaluators_of_inputs() : Evaluators();
  if (std::any_of(formulas.begin(), formulas.end(), switches)) {
    first_order.emplace(with_conditions(model.multibody()->first_order_record()));
    for (int i = 0; i < model.evaluator()->num_parameters(); ++i)
      first_order->set_parameter(i, model.evaluator()->parameter(i));
  }
  TaylorEvaluator* const equations = equations_with_conditions();
  if (equations == nullptr) return;
  const Record& record = equations->record();
  if (record.conditions().empty() && record.timed_switches().empty() && record.stepped_switches().empty()) return;
  conditions.emplace(*equations, first_order ? nullptr : branches_changed);
}

void Solver::end_integration() {
  integration.reset();
  changed.reset();
  if (conditions) conditions->release();
}

void Solver::forget_analysis() {
  end_integration();
  model.forget_system();
  regularized.reset();
  use_breakpoints(options);
  initial_report.reset();
}

// For multibody systems with callbacks it suggests a check of the derivatives; if rows of the array are omitted, the
// complete array.
const char* Solver::hint(int status) const {
  if (status == SFDAE_STOPPED && model.problem().time_is_up()) return " The limit max_seconds of a call has passed.";
  if (status == SFDAE_CHARACTERISTICS_CHANGED && model.follows_structure() && model.multibody() != nullptr)
    return " With structure = SFDAE_STRUCTURE_OFF the constraint that depends on others may be named.";
  if (status == SFDAE_CHARACTERISTICS_CHANGED && model.follows_structure())
    return system() != nullptr && system()->form() == SystemForm::extension
               ? " If structure alone misleads there, structure = SFDAE_STRUCTURE_OFF goes on beyond that point."
               : " Or set structure = SFDAE_STRUCTURE_OFF: rows of the derivative array were left out that may be "
                 "needed there.";
  const bool has_callbacks = model.multibody() != nullptr && model.multibody()->callbacks() != nullptr;
  switch (status) {
    case SFDAE_CHARACTERISTICS_CHANGED:
    case SFDAE_RANK_UNCLEAR:
    case SFDAE_NO_CONSISTENT_VALUES:
    case SFDAE_STEP_TOO_SMALL:
    case SFDAE_SINGULAR:
      return has_callbacks
                 ? " If that is a surprise: sfdae_check_multibody_derivatives compares the derivatives that "
                   "the callbacks supply with differences."
                 : "";
    default: return "";
  }
}

void Solver::set_options(SolverOptions fresh) {
  model.demand_structure(fresh.model.structure);
  fresh.model.for_sensitivities = options.model.for_sensitivities;
  fresh.model.for_adjoint = options.model.for_adjoint;
  fresh.integration.events = events.get();
  use_breakpoints(fresh);
  use_continuation(fresh.integration);
  const ModelOptions &old = options.model, &now = fresh.model;
  const bool same_analysis =
      now.analysis.max_index == old.analysis.max_index && now.analysis.by_svd == old.analysis.by_svd &&
      now.analysis.rank_tol == old.analysis.rank_tol && now.analysis.time_scale == old.analysis.time_scale &&
      now.differences.allowed == old.differences.allowed && now.differences.step == old.differences.step &&
      now.leading == old.leading && now.structure == old.structure;
  const bool goes_on = integration && same_analysis;
  if (goes_on) integration->set_options(fresh.integration);
  // Nothing fails after this point.
  options = std::move(fresh);
  use_tolerances(model, options.integration.tolerances);
  if (!same_analysis) forget_analysis();
  if (goes_on) set_limits(integration->start(), integration->direction());
}

void Solver::set_parameter(const char* name, double value, bool goes_on) {
  TaylorEvaluator* evaluator = model.evaluator();
  const auto number = evaluator != nullptr ? evaluator->find_parameter(name) : std::nullopt;
  if (!number) refuse_argument(format("there is no parameter \"%.60s\" in the equations.", name));
  if (!std::isfinite(value)) refuse_argument(format("the value of parameter \"%.60s\" is %g.", name, value));
  std::optional<Changed> before = std::move(changed);
  if (!before && goes_on && integration && !integration->has_companion()) before = point_returned();
  evaluator->set_parameter(*number, value);
  if (first_order) first_order->set_parameter(*number, value);
  model.parameters_changed();
  forget_analysis();
  changed = std::move(before);
}

// Empty if the solution cannot be evaluated there.
std::optional<Solver::Changed> Solver::point_returned() {
  try {
    Changed found{integration->last_returned(), std::vector<double>(index(model.n())), model.shared_system(),
                  nullptr};
    integration->want_slopes(false);
    if (integration->interpolate(found.t, false, found.x.data(), nullptr).status < 0) return std::nullopt;
    found.integration = std::move(integration);
    return found;
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
  } catch (const std::bad_alloc&) {
    // The parameter changes all the same.
  }
  return std::nullopt;
}

void Solver::demand_integration() const {
  if (changed)
    throw Failure(SFDAE_NOT_STARTED, "parameters have changed: the integration goes on with the next sfdae_advance.");
  if (!integration) throw Failure(SFDAE_NOT_STARTED, "call sfdae_start first.");
}

// Continues as after a jump of data. If this throws, the next call tries it again.
void Solver::go_on_with_parameters(double tout) {
  Changed before = std::move(*changed);
  changed.reset();
  try {
    const double t = before.t;
    const double toward = tout != t ? tout : time_beside(t, before.integration->direction());
    const PointOfInterest point{t, toward, before.x.data()};
    demand_point(point, model.n());
    const KeptValues kept(problem(), t);
    prepare_start(point);
    const UserTime user_time(problem(), t);
    const std::vector<double> sizes = options.model.request_at(point.x).sizes();
    const auto tolerance = [&sizes](int i, const double*) { return sizes[index(i)]; };
    const ConsistentPoint after = jumps.values(point, *model.system(), tolerance, negligible_jump);
    auto next = std::make_unique<Integration>(*model.system(), model.change_watch(), options.integration,
                                              InitialPoint{t, toward, after.x, after.xdot});
    breakpoints->set_differentiations(system()->analysis().values.mu);
    next->take_past(*before.integration);
    integration = std::move(next);
  } catch (...) {
    end_integration();
    changed = std::move(before);
    throw;
  }
}

void Solver::set_events(std::unique_ptr<Events> wanted) {
  if (integration) integration->set_events(wanted.get());
  options.integration.events = wanted.get();
  events = std::move(wanted);
}

void Solver::set_breakpoints(std::vector<double> times, std::vector<char> jump_flags) {
  breakpoints->set_times(std::move(times), std::move(jump_flags));
  use_breakpoints(options);
  if (!integration) return;
  integration->set_breakpoints(options.integration);
  set_limits(integration->start(), direction);
}

void Solver::use_breakpoints(SolverOptions& solver_options) {
  IntegrationOptions& integration_options = solver_options.integration;
  const bool are_smooth = solver_options.has_smooth_conditions;
  breakpoints->take_switches_for_smooth(are_smooth);
  const bool has_any = model.evaluator() != nullptr || breakpoints->has_times();
  integration_options.breakpoints = has_any ? &*breakpoints : nullptr;
  integration_options.inputs = inputs->count() > 0 ? &*inputs : nullptr;
  integration_options.jumps = &jumps;
  integration_options.conditions = conditions && !are_smooth ? &*conditions : nullptr;
  if (regularized) integration_options.conditions = regularized->conditions();
  integration_options.hides_switches = model.evaluator() == nullptr || model.evaluator()->has_source();
}

void Solver::pass_singular_points(long most) {
  max_passed = most;
  use_continuation(options.integration);
  if (integration) integration->set_continuation(options.integration);
}

void Solver::use_continuation(IntegrationOptions& integration_options) {
  integration_options.continuation = max_passed > 0 ? &continuation : nullptr;
  integration_options.max_passed = max_passed;
}

void Solver::record(std::weak_ptr<SolutionPieces> pieces) {
  solution = std::move(pieces);
  if (Integration* const known = known_integration()) known->record(solution);
}

// No evaluations beyond the stop time or the first breakpoint; finite differences stay on this side of the start.
void Solver::set_limits(double t, double toward_direction) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double stop = options.integration.stop_time.value_or(toward_direction * infinity);
  const double piece = breakpoints->end_of_piece(t, toward_direction);
  const double end =
      toward_direction * std::max(toward_direction * t, std::min(toward_direction * stop, toward_direction * piece));
  problem().set_limits(std::min(t, end), std::max(t, end));
  if (regularized) regularized->model().problem().set_limits(std::min(t, end), std::max(t, end));
}

std::vector<double> Solver::prepare_start(const PointOfInterest& point) {
  const double wanted = point.direction();
  std::vector<double> guess(point.x, point.x + model.n());
  breakpoints->set_size(std::max(std::fabs(point.t), std::fabs(point.toward)));
  if (regularized) forget_analysis();
  if (!system() || (wanted != direction && !model.is_constant())) guess = analyze_near(point);
  direction = wanted;
  end_integration();
  jumps.forget();
  set_limits(point.t, wanted);
  return guess;
}

void Solver::make_analysis(PointOfInterest point) {
  const double t = point.t, wanted = point.toward < t ? -1.0 : 1.0;
  const auto& stop = options.integration.stop_time;
  if (stop && (*stop - point.toward) * wanted < 0.0) point.toward = *stop;
  const double piece = breakpoints->end_of_piece(t, wanted);
  if ((piece - point.toward) * wanted < 0.0) point.toward = piece;
  if (point.toward == t) refuse_argument(format("t = %.15g lies at or beyond stop_time.", t));
  set_limits(t, wanted);
  const UserTime user_time(problem(), t);
  forget_analysis();
  const bool checks = options.checks_derivatives;
  try {
    analyze_model(*this, point);
  } catch (const Failure& failure) {
    if (checks && may_be_of_derivatives(failure.status())) model.demand_derivatives(point, options.model);
    throw;
  }
  if (checks) demand_derivatives(*this, point);
  direction = wanted;
}

// True if the analysis has changed the differential part of x beyond the tolerances.
bool Solver::moves_differentiated(const PointOfInterest& point) const {
  const Jet found = model.accepted_point();
  if (found.n == 0) return false;
  const std::vector<double> sizes = options.model.request_at(point.x).sizes();
  std::vector<double> change(sizes.size());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] = found.x[i] - point.x[i];
  return !(system()->change_of_differentiated(change.data(), sizes.data()) <= 1.0);
}

// Users guess algebraic unknowns, and may guess values at which the equations have other ranks than on the solution:
// the flow q = 0 in q |q| = h. Then the analysis fails, or differential unknowns would have to move, although users
// know these. Therefore other guesses of the algebraic unknowns are tried, until one leaves the differential unknowns
// unchanged.
std::vector<double> Solver::analyze_near(const PointOfInterest& point) {
  if (!model.needs_x() || model.has_consistent_motion() || !options.model.request_at(point.x).differentiated_stay()) {
    make_analysis(point);
    return point.x != nullptr ? std::vector<double>(point.x, point.x + model.n()) : std::vector<double>();
  }
  std::vector<char> stays(index(model.n()), 0);
  std::optional<CharacteristicValues> known;
  try {
    make_analysis(point);
    if (!moves_differentiated(point)) return {point.x, point.x + model.n()};
    known = system()->analysis().values;
  } catch (const Failure& failure) {
    if (!may_be_of_guess(failure.status()) || model.fulfils_equations(point)) throw;
  }
  // Unknowns are moved by these parts of max(|x|, 1); the last guess is zero. (Chosen: 0.1 or 1 was enough for 140 of
  // 148 starts that needed another guess.)
  for (const double move : {0.1, -0.1, 1.0, -1.0, 0.0}) {
    try {
      if (system()) model.system()->find_differentiated(stays.data());
      if (auto guess = analyze_beside(point, move, known, stays)) return std::move(*guess);
    } catch (const Failure& failure) {
      if (ends_everything(failure.status())) throw;
    } catch (const std::runtime_error&) {  // of decompositions with overflow
    }
    // Ranks are the same there: constraints move the differential unknowns.
    if (system() && system()->analysis().values == known) break;
  }
  make_analysis(point);
  return {point.x, point.x + model.n()};
}

// stays: flags of the differential unknowns; all 0 if not known yet. If the analysis only finds values by moving these,
// its algebraic unknowns are the next guess.
std::optional<std::vector<double>> Solver::analyze_beside(const PointOfInterest& point, double move,
                                                          const std::optional<CharacteristicValues>& known,
                                                          std::vector<char>& stays) {
  constexpr int most_analyses = 4;
  std::vector<double> guess(stays.size());
  std::minstd_rand numbers;
  for (std::size_t i = 0; i < guess.size(); ++i) {
    const double part = 0.5 + 0.5 * static_cast<double>(numbers()) / static_cast<double>(std::minstd_rand::max());
    const double size = std::max(std::fabs(point.x[i]), 1.0);
    guess[i] = stays[i] != 0 ? point.x[i] : move != 0.0 ? point.x[i] + part * move * size : 0.0;
  }
  if (!all_finite(guess.data(), guess.size())) return std::nullopt;
  const PointOfInterest beside{point.t, point.toward, guess.data(), point.xdot};
  make_analysis(beside);
  if (system()->analysis().values == known) return std::nullopt;
  for (int count = 1; count < most_analyses && moves_differentiated(point); ++count) {
    const Jet found = model.accepted_point();
    model.system()->find_differentiated(stays.data());
    for (std::size_t i = 0; i < guess.size(); ++i) guess[i] = stays[i] == 0 ? found.x[i] : point.x[i];
    make_analysis(beside);
  }
  if (system()->undetermined() > 0 || moves_differentiated(point)) return std::nullopt;
  const ConsistentPoint found = model.consistent_point(beside, options.model);
  if (found.value_change.is_beyond_tolerances()) return std::nullopt;
  // The original guess was consistent, so its result is preferred.
  const std::vector<double> sizes = options.model.request_at(point.x).sizes();
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (std::fabs(found.x[i] - point.x[i]) > sizes[i]) return guess;
  return std::nullopt;
}

CallResult Solver::analyze(const PointOfInterest& point) {
  demand_point(point, model.n());
  const KeptValues kept(problem(), point.t);
  analyze_near(point);
  return warning_of(*system());
}

PointOfInterest Solver::initial_point(double t, double toward, const double* x, const double* xdot) const {
  const PointOfInterest point{t, toward, x, options.xdot_is_guess ? xdot : nullptr};
  demand_point(point, model.n());
  return point;
}

CallResult Solver::make_consistent(double t, double* x, double* xdot) {
  PointOfInterest point = initial_point(t, time_beside(t, direction), x, xdot);
  const KeptValues kept(problem(), t);
  std::vector<double> guess;
  if (!system()) {
    guess = analyze_near(point);
    point.x = guess.data();
  }
  const UserTime user_time(problem(), t);
  const ConsistentPoint found = model.consistent_point_beside(point, options.model);
  CallResult warning = warning_of(*system(), found);
  write(found, x, xdot);
  initial_report = report_of(found);
  if (auto excess = excess_of_differences(found, options.model.tolerances)) return std::move(*excess);
  return warning;
}

CallResult Solver::start(double t, double toward, double* x, double* xdot) {
  PointOfInterest point = initial_point(t, toward, x, xdot);
  const auto& stop = options.integration.stop_time;
  if (stop && (*stop - t) * point.direction() <= 0.0)
    refuse_argument(format("t = %.15g lies at or beyond stop_time = %.15g.", t, *stop));
  const KeptValues kept(problem(), t);
  const std::vector<double> guess = prepare_start(point);
  point.x = guess.data();
  const UserTime user_time(problem(), t);
  const ConsistentPoint found = model.consistent_point(point, options.model);
  CallResult warning = warning_of(*system(), found);
  integration = std::make_unique<Integration>(*model.system(), model.change_watch(), options.integration,
                                              InitialPoint{t, toward, found.x, found.xdot});
  breakpoints->set_differentiations(system()->analysis().values.mu);
  if (sensitivities) {
    try {
      carry_sensitivities(*sensitivities, found, false);
    } catch (...) {
      end_integration();
      throw;
    }
  }
  integration->record(solution);
  write(found, x, xdot);
  initial_report = report_of(found);
  return warning;
}

CallResult Solver::advance(double tout, bool one_step, double& t, double* x, double* xdot) {
  if (changed) go_on_with_parameters(tout);
  demand_integration();
  integration->want_slopes(xdot != nullptr);
  const auto attempts = [this] {
    const IntegrationCounts counts = integration->counts();
    return counts.steps + counts.error_failures + counts.other_failures;
  };
  const long before = attempts();
  CallResult result = integration->advance(tout, one_step, t, x, xdot);
  // A restart counts as an attempt, so that restarts are limited.
  for (long restarts = 1; result.status < 0 && goes_on_with_branches(tout, result); ++restarts) {
    if (attempts() - before + restarts > options.integration.max_steps)
      return result_of_many_steps(options.integration.max_steps, tout, integration->stepper().state().t);
    result = integration->advance(tout, one_step, t, x, xdot);
  }
  return result;
}

Jump Solver::jump(const PointOfInterest& before) {
  demand_jump(*this, before);
  prepare_start(before);
  const UserTime user_time(problem(), before.t);
  return model.whole().jump(before, options.model);
}

Jump Solver::impact(const PointOfInterest& before, const std::vector<double>& restitution) {
  demand_jump(*this, before);
  prepare_start(before);
  const UserTime user_time(problem(), before.t);
  return model.local_coordinates().impact(before, options.model, restitution);
}

std::vector<double> Solver::solution_at(double t) {
  if (integration) {
    std::vector<double> x(index(model.n()));
    integration->want_slopes(false);
    const CallResult result = integration->interpolate(t, false, x.data(), nullptr);
    if (result.status < 0) throw Failure(result.status, result.message);
    return x;
  }
  if (changed) demand_integration();
  if (!system()) throw Failure(SFDAE_NOT_STARTED, "call sfdae_analyze, sfdae_analyze_at or sfdae_start first.");
  const Jet point = model.accepted_point();
  if (point.n == 0) throw Failure(SFDAE_NOT_STARTED, "there is no solution yet: call sfdae_start first.");
  if (point.t != t)
    refuse_argument(
        format("t = %.15g: the one point known before sfdae_start is that of the analysis, t = %.15g.", t, point.t));
  return {point.x.begin(), point.x.begin() + point.n};
}

void Solver::demand_checkpoints() const {
  demand_integration();
  if (integration->adjoint() != nullptr) refuse_argument(no_checkpoints);
}

std::size_t Solver::checkpoint_length() {
  demand_checkpoints();
  return length_of_start(*this) + checkpoint_size(*model.system(), *integration);
}

void Solver::save_checkpoint(double* to, std::size_t length) {
  demand_checkpoints();
  const std::size_t start = length_of_start(*this);
  const std::size_t needed = start + checkpoint_size(*model.system(), *integration);
  if (length < needed) refuse_argument(format("length = %zu, but the checkpoint has %zu doubles.", length, needed));
  core::save_checkpoint(*model.system(), *integration, to + start);
  Archive archive = Archive::writer(to, start);
  archive_start(*this, archive);
}

void Solver::restore_checkpoint(const SavedCheckpoint& saved) {
  if (sensitivities && sensitivities->by_adjoint) refuse_argument(no_checkpoints);
  std::optional<WantedSensitivities> wanted;
  if (sensitivities) wanted.emplace(WantedSensitivities{sensitivities->parameters, sensitivities->options});
  CheckpointStart start = read_start(*this, saved);
  std::unique_ptr<RegularizedEquations> equations;
  try {
    equations = regularize(std::move(start.regularization));
  } catch (const DamagedArchive&) {
    refuse_argument(no_checkpoint);
  }
  std::unique_ptr<RegularizedEquations> before = use(std::move(equations));
  try {
    integration = core::restore_checkpoint(model, options.model, options.integration,
                                           {saved.values + start.length, saved.length - start.length},
                                           wanted ? &*wanted : nullptr);
  } catch (...) {
    use(std::move(before));
    if (integration) integration->restore_branches();
    throw;
  }
  changed.reset();
  integration->restore_branches();
  breakpoints->set_differentiations(system()->analysis().values.mu);
  jumps.forget();
  integration->record(solution);
  decisions = {};
  initial_report.reset();
  direction = integration->direction();
  breakpoints->set_size(integration->size_of_times());
  set_limits(integration->start(), direction);
}

}  // namespace sfdae::core
