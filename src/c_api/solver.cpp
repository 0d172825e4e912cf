// Life cycle, index analysis, initial values, integration: the C API over the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/solver.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "c_api/codes.h"
#include "c_api/creation.h"
#include "c_api/structs.h"
#include "c_api/warnings.h"
#include "integrate/difference_check.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

constexpr const char* no_checkpoints = "checkpoints cannot hold the steps that are kept for the adjoint.";

CallResult not_started(const char* first) { return {SFDAE_NOT_STARTED, format("call %s first.", first)}; }

bool finite_vector(const double* values, int n) { return all_finite(values, index(n)); }

sfdae_initial_report report_of(const ConsistentPoint& point) {
  return {sizeof(sfdae_initial_report),  point.t,
          point.change.residual_before,  point.change.residual_after,
          point.change.largest_change,   point.change.component,
          point.derivative_exact ? 1 : 0};
}

// Failures of an analysis that wrong derivatives may cause.
bool may_be_of_derivatives(int status) { return status <= SFDAE_INDEX_TOO_HIGH && status > SFDAE_MAX_STEPS; }

void analyze_model(sfdae_solver& solver, const PointOfInterest& point) {
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

// An analysis that is not to be trusted is forgotten.
void demand_derivatives(sfdae_solver& solver, const PointOfInterest& point) {
  try {
    solver.model.demand_derivatives(point, solver.options.model);
  } catch (...) {
    solver.forget_analysis();
    throw;
  }
}

}  // namespace

CreationMessage& creation_message() {
  thread_local CreationMessage message = "";
  return message;
}

// Nothing is evaluated beyond the stop time or the first breakpoint, and differences stay on this side of the start.
void set_limits(sfdae_solver& solver, double t, double direction) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double stop = solver.options.integration.stop_time.value_or(direction * infinity);
  const double piece = solver.breakpoints->end_of_piece(t, direction);
  if (direction > 0.0) solver.problem().set_limits(t, std::max(std::min(stop, piece), t));
  else solver.problem().set_limits(std::min(std::max(stop, piece), t), t);
}

void prepare_start(sfdae_solver& solver, const PointOfInterest& point) {
  const double direction = point.direction();
  solver.breakpoints->set_size(std::max(std::fabs(point.t), std::fabs(point.toward)));
  if (!solver.system() || (direction != solver.direction && !solver.model.is_constant())) analyze(solver, point);
  solver.direction = direction;
  solver.integration.reset();
  solver.jumps.forget();
  set_limits(solver, point.t, direction);
}

SolverOptions::SolverOptions(const sfdae_options& o, int n)
    : xdot_is_guess(o.xdot_is_guess != 0), checks_derivatives(o.check_derivatives != 0) {
  model.analysis = {o.max_index, o.reduction == SFDAE_REDUCTION_SVD, o.rank_tol, o.time_scale};
  model.differences = {o.difference_derivatives != 0, o.difference_step, 1.0};
  model.leading = leading_term_of(o.leading_term);
  model.structure = structure_use_of(o.structure);
  model.consistency.kind = initial_values_of(o.initial_values);
  model.consistency.keeps_differentiated = true;
  if (o.initial_values == SFDAE_INITIAL_FIXED)
    for (int i = 0; i < n; ++i) model.consistency.fixed.push_back(static_cast<char>(o.fixed[i]));
  if (o.initial_weights != nullptr) model.consistency.weights.assign(o.initial_weights, o.initial_weights + n);
  const auto tolerance = [n](const double* each, double all) {
    return each != nullptr ? PerComponent(std::vector<double>(each, each + n)) : PerComponent::same(index(n), all);
  };
  model.tolerances = {tolerance(o.rtol_vector, o.rtol), tolerance(o.atol_vector, o.atol)};
  model.analysis.least_useful_pivot = least_useful_pivot(model.tolerances.rtol.different());
  model.ignore_inconsistency = o.ignore_inconsistency != 0;
  model.consistency_tol = o.consistency_tol;
  static_cast<Acceptance&>(integration) = model;
  integration.method = method_of(o.method);
  integration.stepping.max_order = o.max_order;
  integration.stepping.min_stages = o.min_stages;
  integration.stepping.max_stages = o.max_stages;
  integration.interpolates_outputs = o.output == SFDAE_OUTPUT_INTERPOLATED;
  integration.initial_step = o.initial_step;
  integration.max_step = o.max_step;
  if (o.use_stop_time != 0) integration.stop_time = o.stop_time;
  integration.max_steps = o.max_steps;
  integration.monitor = o.monitor;
  integration.monitor_user = o.monitor_user;
}

void analyze(sfdae_solver& solver, PointOfInterest point) {
  const double t = point.t, direction = point.toward < t ? -1.0 : 1.0;
  const auto& stop = solver.options.integration.stop_time;
  if (stop && (*stop - point.toward) * direction < 0.0) point.toward = *stop;
  const double piece = solver.breakpoints->end_of_piece(t, direction);
  if ((piece - point.toward) * direction < 0.0) point.toward = piece;
  if (point.toward == t) throw Failure(SFDAE_ILLEGAL_ARGUMENT, format("t = %.15g lies at or beyond stop_time.", t));
  set_limits(solver, t, direction);
  const UserTime user_time(solver.problem(), t);
  solver.forget_analysis();
  const bool checks = solver.options.checks_derivatives;
  try {
    analyze_model(solver, point);
  } catch (const Failure& failure) {
    if (checks && may_be_of_derivatives(failure.status()))
      solver.model.demand_derivatives(point, solver.options.model);
    throw;
  }
  if (checks) demand_derivatives(solver, point);
  solver.direction = direction;
}

}  // namespace sfdae::core

using namespace sfdae::core;

namespace {

template <class Problem>
struct Arguments {
  Problem problem;
  sfdae_options options;
};

template <class Problem>
int unknowns_of(const Problem& problem) {
  return problem.num_unknowns;
}

int unknowns_of(const sfdae_multibody_problem& problem) {
  return problem.num_positions + (problem.num_velocities > 0 ? problem.num_velocities : problem.num_positions) +
         problem.num_constraints + problem.num_nonholonomic;
}

template <class Problem>
CallResult read_arguments(const Problem* problem, const sfdae_options* options, const Problem& defaults,
                          Arguments<Problem>& result) {
  if (problem == nullptr) return illegal_argument("problem is NULL.");
  if (!is_plausible_size(problem->size))
    return illegal_argument("problem->size is not set: call the init function of problems.");
  if (options != nullptr && !is_plausible_size(options->size))
    return illegal_argument("options->size is not set: call sfdae_options_init.");
  result.problem = read_struct(*problem, defaults);
  result.options = options != nullptr ? read_struct(*options, default_options()) : default_options();
  const CallResult checked = check_problem(result.problem);
  return checked.status == SFDAE_OK ? check_options(result.options, unknowns_of(result.problem)) : checked;
}

void demand_structure(const Model& model, StructureUse wanted) {
  if (wanted != StructureUse::required || model.has_structure()) return;
  throw Failure(
      SFDAE_ILLEGAL_ARGUMENT,
      "structure = SFDAE_STRUCTURE_REQUIRED is for recorded equations, as many as unknowns, without prescribed "
      "components and differentiations.");
}

template <class Problem>
int create(sfdae_solver** solver, const Problem* problem, const sfdae_options* options, const Problem& defaults) {
  if (solver != nullptr) *solver = nullptr;
  return creating([&]() -> CallResult {
    if (solver == nullptr) return illegal_argument("solver, where the new one goes, is NULL.");
    Arguments<Problem> arguments;
    CallResult result = read_arguments(problem, options, defaults, arguments);
    if (result.status != SFDAE_OK) return result;
    AnyModel model = make_model(arguments.problem);
    demand_structure(*model.model, structure_use_of(arguments.options.structure));
    *solver = new sfdae_solver(std::move(model), arguments.options);
    return result;
  });
}

template <class Problem>
int check(const Problem* problem, const sfdae_options* options, const Problem& defaults, char* text, size_t length) {
  if (text == nullptr && length > 0) return SFDAE_ILLEGAL_ARGUMENT;
  const auto body = [&] {
    Arguments<Problem> arguments;
    const CallResult checked = read_arguments(problem, options, defaults, arguments);
    if (checked.status == SFDAE_OK)
      demand_structure(*make_model(arguments.problem).model, structure_use_of(arguments.options.structure));
    return checked;
  };
  return status_of(body, [=](int status, const char* message) {
    if (length > 0) std::snprintf(text, length, "%s", message);
    return status;
  });
}

CheckpointIdentity identity_of_integration(sfdae_solver& solver) {
  return identity_of(solver.model, solver.options.model, solver.integration->chosen_method());
}

// The number of doubles that the identity of the checkpoint takes; it has to be that of this solver. Throws Failure.
std::size_t end_of_identity(sfdae_solver& solver, const SavedCheckpoint& saved) {
  Archive archive = Archive::reader(saved.values, saved.length);
  try {
    identity_of(solver.model, solver.options.model, solver.options.integration.method).demand_same(archive);
  } catch (const DamagedArchive&) {
    throw Failure(SFDAE_ILLEGAL_ARGUMENT, "this is not a checkpoint of this version, or it is damaged.");
  }
  return archive.size();
}

CallResult advance(sfdae_solver* solver, double tout, bool one_step, double* t, double* x, double* xdot) {
  if (t == nullptr || x == nullptr) return illegal_argument("t and x must not be NULL.");
  if (!std::isfinite(tout)) return illegal_argument(format("tout is %g.", tout));
  if (!solver->integration) return not_started("sfdae_start");
  solver->integration->want_slopes(xdot != nullptr);
  return solver->integration->advance(tout, one_step, *t, x, xdot);
}

CallResult check_point(double t, double toward, const double* x, int n) {
  if (!std::isfinite(t) || !std::isfinite(toward) || t == toward)
    return illegal_argument(format("t = %g, toward = %g: must be finite and different.", t, toward));
  if (n > 0 && x == nullptr) return illegal_argument("x is NULL.");
  if (n > 0 && !finite_vector(x, n)) return illegal_argument("x contains NaN or Inf.");
  return {};
}

// A point that initial values are asked for at, with the guess of x' if xdot is one.
CallResult check_initial_point(const sfdae_solver& solver, const PointOfInterest& point) {
  const int n = solver.model.n();
  const CallResult checked = check_point(point.t, point.toward, point.x, n);
  if (checked.status != SFDAE_OK || point.xdot == nullptr || finite_vector(point.xdot, n)) return checked;
  return illegal_argument("xdot, which is a guess, contains NaN or Inf.");
}

PointOfInterest initial_point(const sfdae_solver& solver, double t, double toward, const double* x,
                              const double* xdot) {
  return {t, toward, x, solver.options.xdot_is_guess ? xdot : nullptr};
}

}  // namespace

extern "C" {

int sfdae_check_linear(const sfdae_linear_problem* problem, const sfdae_options* options, char* text, size_t length) {
  return check(problem, options, default_problem(), text, length);
}

int sfdae_check_nonlinear(const sfdae_nonlinear_problem* problem, const sfdae_options* options, char* text,
                          size_t length) {
  return check(problem, options, default_nonlinear_problem(), text, length);
}

int sfdae_check_multibody(const sfdae_multibody_problem* problem, const sfdae_options* options, char* text,
                          size_t length) {
  return check(problem, options, default_multibody_problem(), text, length);
}

int sfdae_create_linear(sfdae_solver** solver, const sfdae_linear_problem* problem, const sfdae_options* options) {
  return create(solver, problem, options, default_problem());
}

int sfdae_create_nonlinear(sfdae_solver** solver, const sfdae_nonlinear_problem* problem,
                           const sfdae_options* options) {
  return create(solver, problem, options, default_nonlinear_problem());
}

int sfdae_create_multibody(sfdae_solver** solver, const sfdae_multibody_problem* problem,
                           const sfdae_options* options) {
  return create(solver, problem, options, default_multibody_problem());
}

int sfdae_destroy(sfdae_solver** solver) {
  if (solver == nullptr || *solver == nullptr) return SFDAE_OK;
  if ((*solver)->busy.load() || (*solver)->hybrid != nullptr) return SFDAE_BUSY;
  delete *solver;
  *solver = nullptr;
  return SFDAE_OK;
}

int sfdae_set_options(sfdae_solver* solver, const sfdae_options* options) {
  return guarded(solver, [&]() -> CallResult {
    if (options == nullptr || !is_plausible_size(options->size))
      return illegal_argument("options is NULL or its size is not set: call sfdae_options_init.");
    const sfdae_options copy = read_struct(*options, default_options());
    const CallResult checked = check_options(copy, solver->model.n());
    if (checked.status != SFDAE_OK) return checked;
    SolverOptions fresh(copy, solver->model.n());
    demand_structure(solver->model, fresh.model.structure);
    fresh.model.for_sensitivities = solver->options.model.for_sensitivities;
    fresh.model.for_adjoint = solver->options.model.for_adjoint;
    fresh.integration.events = solver->events.get();
    solver->use_breakpoints(fresh.integration);
    solver->use_continuation(fresh.integration);
    const ModelOptions &old = solver->options.model, &now = fresh.model;
    const bool same_analysis =
        now.analysis.max_index == old.analysis.max_index && now.analysis.by_svd == old.analysis.by_svd &&
        now.analysis.rank_tol == old.analysis.rank_tol && now.analysis.time_scale == old.analysis.time_scale &&
        now.differences.allowed == old.differences.allowed && now.differences.step == old.differences.step &&
        now.leading == old.leading && now.structure == old.structure;
    const bool goes_on = solver->integration && same_analysis;
    if (goes_on) solver->integration->set_options(fresh.integration);
    // Nothing fails from here on.
    solver->options = std::move(fresh);
    if (!same_analysis) solver->forget_analysis();
    if (goes_on) set_limits(*solver, solver->integration->start(), solver->integration->direction());
    return {};
  });
}

const char* sfdae_message(const sfdae_solver* solver) {
  return solver == nullptr ? creation_message() : solver->message;
}

int sfdae_request_stop(sfdae_solver* solver) {
  if (solver == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  solver->problem().request_stop();
  return SFDAE_OK;
}

int sfdae_analyze(sfdae_solver* solver, double t, double toward, sfdae_characteristics* result) {
  return guarded(solver, [&]() -> CallResult {
    CallResult checked = check_point(t, toward, nullptr, 0);
    if (checked.status != SFDAE_OK) return checked;
    if (result != nullptr && !is_plausible_size(result->size))
      return illegal_argument("result->size is not set: call sfdae_characteristics_init.");
    if (solver->model.needs_x())
      return illegal_argument("the characteristic values of a nonlinear problem depend on x: call sfdae_analyze_at.");
    const KeptValues kept(solver->problem(), t);
    analyze(*solver, {t, toward, nullptr});
    CallResult warning = warning_of(*solver->system());
    if (result != nullptr) fill_struct(result, characteristics_of(*solver));
    return warning;
  });
}

int sfdae_analyze_at(sfdae_solver* solver, double t, double toward, const double* x, sfdae_characteristics* result) {
  return guarded(solver, [&]() -> CallResult {
    CallResult checked = check_point(t, toward, x, solver->model.n());
    if (checked.status != SFDAE_OK) return checked;
    if (result != nullptr && !is_plausible_size(result->size))
      return illegal_argument("result->size is not set: call sfdae_characteristics_init.");
    const KeptValues kept(solver->problem(), t);
    analyze(*solver, {t, toward, x});
    CallResult warning = warning_of(*solver->system());
    if (result != nullptr) fill_struct(result, characteristics_of(*solver));
    return warning;
  });
}

int sfdae_set_parameter(sfdae_solver* solver, const char* name, double value) {
  return guarded(solver, [&]() -> CallResult {
    if (name == nullptr) return illegal_argument("name is NULL.");
    TaylorEvaluator* evaluator = solver->model.evaluator();
    const auto index = evaluator != nullptr ? evaluator->find_parameter(name) : std::nullopt;
    if (!index) return illegal_argument(format("there is no parameter \"%.60s\" in the equations.", name));
    if (!std::isfinite(value))
      return illegal_argument(format("the value of parameter \"%.60s\" is %g.", name, value));
    evaluator->set_parameter(*index, value);
    solver->model.parameters_changed();
    solver->forget_analysis();
    return {};
  });
}

int sfdae_make_consistent(sfdae_solver* solver, double t, double* x, double* xdot) {
  return guarded(solver, [&]() -> CallResult {
    const PointOfInterest point = initial_point(*solver, t, time_beside(t, solver->direction), x, xdot);
    const CallResult checked = check_initial_point(*solver, point);
    if (checked.status != SFDAE_OK) return checked;
    const KeptValues kept(solver->problem(), t);
    if (!solver->system()) analyze(*solver, point);
    const UserTime user_time(solver->problem(), t);
    const ConsistentPoint found = solver->model.consistent_point_beside(point, solver->options.model);
    CallResult warning = warning_of(*solver->system(), found);
    std::copy(found.x.begin(), found.x.end(), x);
    if (xdot != nullptr) std::copy(found.xdot.begin(), found.xdot.end(), xdot);
    solver->initial_report = report_of(found);
    if (auto excess = excess_of_differences(found, solver->options.model.tolerances)) return std::move(*excess);
    return warning;
  });
}

int sfdae_start(sfdae_solver* solver, double t, double toward, double* x, double* xdot) {
  return guarded(solver, [&]() -> CallResult {
    const PointOfInterest point = initial_point(*solver, t, toward, x, xdot);
    const CallResult checked = check_initial_point(*solver, point);
    if (checked.status != SFDAE_OK) return checked;
    const double direction = point.direction();
    const auto& stop = solver->options.integration.stop_time;
    if (stop && (*stop - t) * direction <= 0.0)
      return illegal_argument(format("t = %.15g lies at or beyond stop_time = %.15g.", t, *stop));
    const KeptValues kept(solver->problem(), t);
    prepare_start(*solver, point);
    const UserTime user_time(solver->problem(), t);
    const ConsistentPoint found = solver->model.consistent_point(point, solver->options.model);
    CallResult warning = warning_of(*solver->system(), found);
    solver->integration =
        std::make_unique<Integration>(*solver->model.system(), solver->model.change_watch(),
                                      solver->options.integration, InitialPoint{t, toward, found.x, found.xdot});
    solver->note_differentiations();
    carry_sensitivities(*solver, found);
    solver->integration->record(solver->solution);
    std::copy(found.x.begin(), found.x.end(), x);
    if (xdot != nullptr) std::copy(found.xdot.begin(), found.xdot.end(), xdot);
    solver->initial_report = report_of(found);
    return warning;
  });
}

int sfdae_advance(sfdae_solver* solver, double tout, double* t, double* x, double* xdot) {
  return guarded(solver, [&] { return advance(solver, tout, false, t, x, xdot); });
}

int sfdae_step(sfdae_solver* solver, double tout, double* t, double* x, double* xdot) {
  return guarded(solver, [&] { return advance(solver, tout, true, t, x, xdot); });
}

int sfdae_get_checkpoint_length(sfdae_solver* solver, size_t* length) {
  return guarded<Text::of_failure>(solver, [&]() -> CallResult {
    if (length == nullptr) return illegal_argument("length is NULL.");
    if (!solver->integration) return not_started("sfdae_start");
    if (solver->integration->adjoint() != nullptr) return illegal_argument(no_checkpoints);
    *length =
        identity_of_integration(*solver).size() + checkpoint_size(*solver->model.system(), *solver->integration);
    return {};
  });
}

int sfdae_save_checkpoint(sfdae_solver* solver, double* checkpoint, size_t length) {
  return guarded(solver, [&]() -> CallResult {
    if (checkpoint == nullptr) return illegal_argument("checkpoint is NULL.");
    if (!solver->integration) return not_started("sfdae_start");
    if (solver->integration->adjoint() != nullptr) return illegal_argument(no_checkpoints);
    const CheckpointIdentity identity = identity_of_integration(*solver);
    const std::size_t needed = identity.size() + checkpoint_size(*solver->model.system(), *solver->integration);
    if (length < needed)
      return illegal_argument(format("length = %zu, but the checkpoint has %zu doubles.", length, needed));
    save_checkpoint(*solver->model.system(), *solver->integration, checkpoint + identity.size());
    Archive archive = Archive::writer(checkpoint, identity.size());
    identity.write(archive);
    return {};
  });
}

int sfdae_restore_checkpoint(sfdae_solver* solver, const double* checkpoint, size_t length) {
  return guarded(solver, [&]() -> CallResult {
    if (checkpoint == nullptr) return illegal_argument("checkpoint is NULL.");
    const auto& asked = solver->sensitivities;
    if (asked && asked->by_adjoint) return illegal_argument(no_checkpoints);
    std::optional<WantedSensitivities> wanted;
    if (asked) wanted.emplace(WantedSensitivities{asked->parameters, asked->options});
    const std::size_t begin = end_of_identity(*solver, {checkpoint, length});
    solver->integration = restore_checkpoint(solver->model, solver->options.model, solver->options.integration,
                                             {checkpoint + begin, length - begin}, wanted ? &*wanted : nullptr);
    solver->note_differentiations();
    solver->jumps.forget();
    solver->integration->record(solver->solution);
    solver->decisions = {};
    solver->initial_report.reset();
    solver->direction = solver->integration->direction();
    solver->breakpoints->set_size(solver->integration->size_of_times());
    set_limits(*solver, solver->integration->start(), solver->direction);
    return {};
  });
}

}  // extern "C"
