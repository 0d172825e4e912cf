// Life cycle, index analysis, initial values, integration: the C API over the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/solver.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "c_api/structs.h"
#include "integrate/checkpoint.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

CallResult not_started(const char* first) {
  return {SFDAE_NOT_STARTED, format("call %s first.", first)};
}

bool finite_vector(const double* values, int n) { return all_finite(values, static_cast<std::size_t>(n)); }

// Nothing is evaluated beyond the stop time, and differences stay on this side of the start.
void set_limits(sfdae_solver& solver, double t, double direction) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double stop = solver.options.integration.stop_time.value_or(direction * infinity);
  if (direction > 0.0) solver.problem.set_limits(t, std::max(stop, t));
  else solver.problem.set_limits(std::min(stop, t), t);
}

// A system at t on which questions can be asked without disturbing the integration.
std::unique_ptr<LinearSystem> side_system(sfdae_solver& solver) {
  return std::make_unique<LinearSystem>(solver.problem, solver.options.analysis, solver.system->analysis(),
                                        solver.system->leading_term());
}

void move_system(LinearSystem& system, double t) {
  PointStatus status = system.move_to(t);
  if (status == PointStatus::leading_changed) {
    system.give_up_projector();
    status = system.move_to(t);
  }
  if (status == PointStatus::trouble) throw Failure(system.trouble().status, system.trouble().message());
  if (status == PointStatus::changed)
    throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                  "the characteristic values known (" + describe(system.analysis().values) +
                      format(") do not hold at t = %.15g. Call sfdae_analyze there.", t));
}

struct Consistent {
  std::vector<double> x, xdot;
  sfdae_initial_report report;
  bool contradiction = false;
};

Consistent consistent_values(sfdae_solver& solver, LinearSystem& system, double t, double direction, const double* x) {
  const int n = solver.problem.n();
  move_system(system, t);
  Consistent result;
  const IntegrationOptions& integration = solver.options.integration;
  if (system.inconsistency() > integration.consistency_tol) {
    if (!integration.ignore_inconsistency)
      throw Failure(SFDAE_INCONSISTENT_EQUATIONS, system.inconsistency_message());
    result.contradiction = true;
  }
  result.x.assign(x, x + n);
  ConsistencyRequest request = solver.options.consistency;
  for (int i = 0; i < n; ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    request.tolerances.push_back(integration.tolerances.rtol[at] * std::fabs(x[i]) + integration.tolerances.atol[at]);
  }
  const ConsistencyResult found = make_consistent(system, request, result.x);
  result.xdot.resize(static_cast<std::size_t>(n));
  const bool exact = system.consistent_derivative(result.x.data(), direction, result.xdot.data());
  if (!finite_vector(result.xdot.data(), n))
    throw Failure(SFDAE_NOT_FINITE, format("the derivative of the initial values overflows at t = %.15g.", t));
  result.report = {sizeof(sfdae_initial_report), t, found.residual_before, found.residual_after, found.largest_change,
                   found.component, exact ? 1 : 0};
  return result;
}

CallResult remark(const sfdae_solver& solver, bool contradiction) {
  if (contradiction)
    return {SFDAE_INCONSISTENCY_IGNORED, "redundant equations contradict each other; ignored as asked for."};
  const int u = solver.system->undetermined();
  if (u == 0) return {};
  return {SFDAE_NOT_UNIQUE, format("the solution is not unique: %d component(s) are free (u = %d). The free part is held "
                                   "constant; prescribe components to choose another solution.",
                                   u, solver.system->analysis().values.u)};
}

}  // namespace

SolverOptions::SolverOptions(const sfdae_options& o, int n) {
  analysis = {o.max_index, o.reduction == SFDAE_REDUCTION_SVD, o.rank_tol, o.time_scale};
  differences = {o.difference_derivatives != 0, o.difference_step, 1.0};
  leading = static_cast<LeadingTerm>(o.leading_term);
  consistency.kind = static_cast<InitialValues>(o.initial_values);
  if (o.initial_values == SFDAE_INITIAL_FIXED)
    for (int i = 0; i < n; ++i) consistency.fixed.push_back(static_cast<char>(o.fixed[i]));
  if (o.initial_weights != nullptr) consistency.weights.assign(o.initial_weights, o.initial_weights + n);
  for (int i = 0; i < n; ++i) {
    integration.tolerances.rtol.push_back(o.rtol_vector != nullptr ? o.rtol_vector[i] : o.rtol);
    integration.tolerances.atol.push_back(o.atol_vector != nullptr ? o.atol_vector[i] : o.atol);
  }
  integration.method = static_cast<Method>(o.method);
  integration.stepping.max_order = o.max_order;
  integration.stepping.min_stages = o.min_stages;
  integration.stepping.max_stages = o.max_stages;
  integration.initial_step = o.initial_step;
  integration.max_step = o.max_step;
  if (o.use_stop_time != 0) integration.stop_time = o.stop_time;
  integration.max_steps = o.max_steps;
  integration.ignore_inconsistency = o.ignore_inconsistency != 0;
  integration.consistency_tol = o.consistency_tol;
  integration.monitor = o.monitor;
  integration.monitor_user = o.monitor_user;
}

void analyze(sfdae_solver& solver, double t, double toward) {
  const double direction = toward < t ? -1.0 : 1.0;
  const auto& stop = solver.options.integration.stop_time;
  if (stop && (*stop - toward) * direction < 0.0) toward = *stop;
  if (toward == t) throw Failure(SFDAE_ILLEGAL_ARGUMENT, format("t = %.15g lies at or beyond stop_time.", t));
  set_limits(solver, t, direction);
  DifferenceOptions differences = solver.options.differences;
  differences.span = std::fabs(toward - t);
  solver.problem.set_differences(differences);
  Arena arena;
  solver.integration.reset();
  solver.system.reset();
  solver.initial_report.reset();
  IndexAnalysis analysis = analyze_index(solver.problem, t, toward, solver.options.analysis, arena, solver.decisions);
  auto system = std::make_unique<LinearSystem>(solver.problem, solver.options.analysis, std::move(analysis),
                                               solver.options.leading);
  solver.system = std::move(system);
  solver.direction = direction;
}

}  // namespace sfdae::core

using namespace sfdae::core;

namespace {

CallResult check_arguments(const sfdae_linear_problem* problem, const sfdae_options* options,
                           sfdae_linear_problem& problem_copy, sfdae_options& options_copy) {
  if (problem == nullptr) return illegal_argument("problem is NULL.");
  if (!is_plausible_size(problem->size)) return illegal_argument("problem->size is not set: call sfdae_linear_problem_init.");
  if (options != nullptr && !is_plausible_size(options->size))
    return illegal_argument("options->size is not set: call sfdae_options_init.");
  problem_copy = read_struct(*problem, default_problem());
  options_copy = options != nullptr ? read_struct(*options, default_options()) : default_options();
  CallResult result = check_problem(problem_copy);
  return result.status == SFDAE_OK ? check_options(options_copy, problem_copy.num_unknowns) : result;
}

CallResult advance(sfdae_solver* solver, double tout, bool one_step, double* t, double* x, double* xdot) {
  if (t == nullptr || x == nullptr) return illegal_argument("t and x must not be NULL.");
  if (!std::isfinite(tout)) return illegal_argument(format("tout is %g.", tout));
  if (!solver->integration) return not_started("sfdae_start");
  solver->integration->want_slopes(xdot != nullptr);
  std::vector<double> slopes;
  if (xdot == nullptr) {
    slopes.resize(static_cast<std::size_t>(solver->problem.n()));
    xdot = slopes.data();
  }
  return solver->integration->advance(tout, one_step, *t, x, xdot);
}

CallResult check_point(double t, double toward, const double* x, int n) {
  if (!std::isfinite(t) || !std::isfinite(toward) || t == toward)
    return illegal_argument(format("t = %g, toward = %g: must be finite and different.", t, toward));
  if (n > 0 && x == nullptr) return illegal_argument("x is NULL.");
  if (n > 0 && !finite_vector(x, n)) return illegal_argument("x contains NaN or Inf.");
  return {};
}

}  // namespace

extern "C" {

int sfdae_check_linear(const sfdae_linear_problem* problem, const sfdae_options* options, char* text, size_t length) {
  if (text == nullptr && length > 0) return SFDAE_ILLEGAL_ARGUMENT;
  CallResult result;
  try {
    sfdae_linear_problem problem_copy;
    sfdae_options options_copy;
    result = check_arguments(problem, options, problem_copy, options_copy);
  } catch (...) {
    result.status = SFDAE_OUT_OF_MEMORY;
  }
  if (text != nullptr && length > 0) std::snprintf(text, length, "%s", result.message.c_str());
  return result.status;
}

int sfdae_create_linear(sfdae_solver** solver, const sfdae_linear_problem* problem, const sfdae_options* options) {
  if (solver == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  *solver = nullptr;
  try {
    sfdae_linear_problem problem_copy;
    sfdae_options options_copy;
    const CallResult result = check_arguments(problem, options, problem_copy, options_copy);
    if (result.status != SFDAE_OK) return result.status;
    *solver = new sfdae_solver(problem_copy, options_copy);
    return SFDAE_OK;
  } catch (const std::bad_alloc&) {
    return SFDAE_OUT_OF_MEMORY;
  } catch (...) {
    return SFDAE_INTERNAL;
  }
}

int sfdae_destroy(sfdae_solver** solver) {
  if (solver == nullptr || *solver == nullptr) return SFDAE_OK;
  if ((*solver)->busy.load()) return SFDAE_BUSY;
  delete *solver;
  *solver = nullptr;
  return SFDAE_OK;
}

int sfdae_set_options(sfdae_solver* solver, const sfdae_options* options) {
  return guarded(solver, [&]() -> CallResult {
    if (options == nullptr || !is_plausible_size(options->size))
      return illegal_argument("options is NULL or its size is not set: call sfdae_options_init.");
    const sfdae_options copy = read_struct(*options, default_options());
    const CallResult checked = check_options(copy, solver->problem.n());
    if (checked.status != SFDAE_OK) return checked;
    SolverOptions fresh(copy, solver->problem.n());
    fresh.integration.events = solver->events.get();
    const SolverOptions& old = solver->options;
    const bool same_analysis =
        fresh.analysis.max_index == old.analysis.max_index && fresh.analysis.by_svd == old.analysis.by_svd &&
        fresh.analysis.rank_tol == old.analysis.rank_tol && fresh.analysis.time_scale == old.analysis.time_scale &&
        fresh.differences.allowed == old.differences.allowed && fresh.differences.step == old.differences.step &&
        fresh.leading == old.leading;
    solver->options = fresh;
    if (!same_analysis) {
      solver->integration.reset();
      solver->system.reset();
      solver->initial_report.reset();
    }
    if (solver->integration) {
      solver->integration->set_options(fresh.integration);
      set_limits(*solver, solver->integration->stepper().t(), solver->integration->direction());
    }
    return {};
  });
}

const char* sfdae_message(const sfdae_solver* solver) { return solver == nullptr ? "" : solver->message; }

int sfdae_request_stop(sfdae_solver* solver) {
  if (solver == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  solver->problem.request_stop();
  return SFDAE_OK;
}

int sfdae_analyze(sfdae_solver* solver, double t, double toward, sfdae_characteristics* result) {
  return guarded(solver, [&]() -> CallResult {
    CallResult checked = check_point(t, toward, nullptr, 0);
    if (checked.status != SFDAE_OK) return checked;
    if (result != nullptr && !is_plausible_size(result->size))
      return illegal_argument("result->size is not set: call sfdae_characteristics_init.");
    analyze(*solver, t, toward);
    if (result != nullptr) fill_struct(result, characteristics_of(*solver));
    return remark(*solver, false);
  });
}

int sfdae_make_consistent(sfdae_solver* solver, double t, double* x, double* xdot) {
  return guarded(solver, [&]() -> CallResult {
    const double toward = t + solver->direction * std::max(1.0, 1e-6 * std::fabs(t));
    CallResult checked = check_point(t, toward, x, solver->problem.n());
    if (checked.status != SFDAE_OK) return checked;
    if (!solver->system) analyze(*solver, t, toward);
    const auto system = side_system(*solver);
    const Consistent found = consistent_values(*solver, *system, t, solver->direction, x);
    std::copy(found.x.begin(), found.x.end(), x);
    if (xdot != nullptr) std::copy(found.xdot.begin(), found.xdot.end(), xdot);
    solver->initial_report = found.report;
    return remark(*solver, found.contradiction);
  });
}

int sfdae_start(sfdae_solver* solver, double t, double toward, double* x, double* xdot) {
  return guarded(solver, [&]() -> CallResult {
    CallResult checked = check_point(t, toward, x, solver->problem.n());
    if (checked.status != SFDAE_OK) return checked;
    const double direction = toward < t ? -1.0 : 1.0;
    const auto& stop = solver->options.integration.stop_time;
    if (stop && (*stop - t) * direction <= 0.0)
      return illegal_argument(format("t = %.15g lies at or beyond stop_time = %.15g.", t, *stop));
    if (!solver->system || (direction != solver->direction && !solver->problem.is_constant()))
      analyze(*solver, t, toward);
    solver->direction = direction;
    solver->integration.reset();
    set_limits(*solver, t, direction);
    const Consistent found = consistent_values(*solver, *solver->system, t, direction, x);
    solver->integration = std::make_unique<Integration>(*solver->system, solver->options.integration, t, toward,
                                                        found.x, found.xdot);
    std::copy(found.x.begin(), found.x.end(), x);
    if (xdot != nullptr) std::copy(found.xdot.begin(), found.xdot.end(), xdot);
    solver->initial_report = found.report;
    return remark(*solver, found.contradiction);
  });
}

int sfdae_advance(sfdae_solver* solver, double tout, double* t, double* x, double* xdot) {
  return guarded(solver, [&] { return advance(solver, tout, false, t, x, xdot); });
}

int sfdae_step(sfdae_solver* solver, double tout, double* t, double* x, double* xdot) {
  return guarded(solver, [&] { return advance(solver, tout, true, t, x, xdot); });
}

int sfdae_get_checkpoint_length(sfdae_solver* solver, size_t* length) {
  return guarded(solver, [&]() -> CallResult {
    if (length == nullptr) return illegal_argument("length is NULL.");
    if (!solver->integration) return not_started("sfdae_start");
    *length = checkpoint_size(*solver->system, *solver->integration);
    return {};
  });
}

int sfdae_save_checkpoint(sfdae_solver* solver, double* checkpoint, size_t length) {
  return guarded(solver, [&]() -> CallResult {
    if (checkpoint == nullptr) return illegal_argument("checkpoint is NULL.");
    if (!solver->integration) return not_started("sfdae_start");
    const std::size_t needed = checkpoint_size(*solver->system, *solver->integration);
    if (length < needed) return illegal_argument(format("length = %zu, but the checkpoint has %zu doubles.", length, needed));
    save_checkpoint(*solver->system, *solver->integration, checkpoint);
    return {};
  });
}

int sfdae_restore_checkpoint(sfdae_solver* solver, const double* checkpoint, size_t length) {
  return guarded(solver, [&]() -> CallResult {
    if (checkpoint == nullptr) return illegal_argument("checkpoint is NULL.");
    solver->integration.reset();
    solver->system.reset();
    solver->initial_report.reset();
    solver->decisions.clear();
    solver->problem.set_differences(solver->options.differences);
    Restored restored = restore_checkpoint(solver->problem, solver->options.analysis, solver->options.integration,
                                           checkpoint, length);
    solver->system = std::move(restored.system);
    solver->integration = std::move(restored.integration);
    solver->direction = solver->integration->direction();
    // Differences go on from where the integration started.
    const double start = solver->problem.limit_behind(solver->direction), t = solver->integration->stepper().t();
    set_limits(*solver, solver->options.differences.allowed && std::isfinite(start) ? start : t, solver->direction);
    return {};
  });
}

}  // extern "C"
