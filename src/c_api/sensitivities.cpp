// Sensitivities: the C API over the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/sensitivities.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "c_api/solver.h"
#include "c_api/structs.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

sfdae_sensitivity_options default_sensitivity_options() {
  sfdae_sensitivity_options options{};
  options.size = sizeof options;
  return options;
}

CallResult read_parameters(sfdae_solver& solver, int count, const char* const* names, std::vector<int>& parameters) {
  parameters.assign(index(count), -1);
  for (int j = 0; j < count && names != nullptr; ++j) {
    if (names[j] == nullptr) continue;
    const auto found = solver.model.evaluator()->find_parameter(names[j]);
    if (!found)
      return illegal_argument(
          format("parameters[%d]: there is no parameter \"%.60s\" in the equations.", j, names[j]));
    parameters[index(j)] = *found;
  }
  return {};
}

}  // namespace

CallResult read_sensitivity_options(int count, const sfdae_sensitivity_options* given, SensitivityRequest& request) {
  SensitivityOptions& options = request.options;
  options.scales.assign(index(count), 1.0);
  if (given == nullptr) return {};
  if (!is_plausible_size(given->size))
    return illegal_argument("options->size is not set: call sfdae_sensitivity_options_init.");
  const sfdae_sensitivity_options read = read_struct(*given, default_sensitivity_options());
  if (read.error_test != 0 && read.error_test != 1)
    return illegal_argument(format("error_test = %d; it must be 0 or 1.", read.error_test));
  if (read.adjoint != 0 && read.adjoint != 1)
    return illegal_argument(format("adjoint = %d; it must be 0 or 1.", read.adjoint));
  if (read.adjoint == 1 && read.error_test == 1)
    return illegal_argument("error_test = 1 and adjoint = 1 exclude each other: there is no S to be tested then.");
  if (read.max_kept_steps < 0 || read.max_kept_steps == 1)
    return illegal_argument(format("max_kept_steps = %ld; it must be 0 or at least 2.", read.max_kept_steps));
  if (read.max_kept_steps > 0 && read.adjoint == 0)
    return illegal_argument("max_kept_steps is for adjoint = 1: forward sensitivities keep no steps.");
  request.by_adjoint = read.adjoint == 1;
  request.max_kept_steps = read.max_kept_steps;
  options.error_test = read.error_test == 1;
  for (int j = 0; j < count && read.scales != nullptr; ++j) {
    if (!std::isfinite(read.scales[j]) || read.scales[j] <= 0.0)
      return illegal_argument(format("scales[%d] = %g; it must be positive.", j, read.scales[j]));
    options.scales[index(j)] = read.scales[j];
  }
  return {};
}

CallResult check_functionals(const GivenFunctionals& given) {
  if (given.num_times < 1 || given.num_functionals < 1)
    return illegal_argument(format("num_times = %d, num_functionals = %d; both must be positive.", given.num_times,
                                   given.num_functionals));
  for (int k = 0; k < given.num_times; ++k)
    if (!std::isfinite(given.t[k])) return illegal_argument(format("t[%d] is %g.", k, given.t[k]));
  if (!all_finite(given.weights, index(given.n) * index(given.num_times) * index(given.num_functionals)))
    return illegal_argument("weights has entries that are not finite.");
  return {};
}

void take_sensitivities(sfdae_solver& solver, std::optional<SensitivityRequest> request) {
  const bool wanted = request.has_value();
  const bool by_adjoint = wanted && request->by_adjoint;
  ModelOptions& options = solver.options.model;
  if (wanted != options.for_sensitivities || by_adjoint != options.for_adjoint) solver.forget_analysis();
  solver.integration.reset();
  options.for_sensitivities = wanted;
  options.for_adjoint = by_adjoint;
  solver.sensitivities = std::move(request);
}

namespace {

CallResult read_request(sfdae_solver& solver, int count, const char* const* names, const double* directions,
                        const sfdae_sensitivity_options* options, SensitivityRequest& request) {
  if (count < 0 || count > most_sensitivities)
    return illegal_argument(format("count = %d; it must be 0 ... %d.", count, most_sensitivities));
  if (count > 0 && solver.model.evaluator() == nullptr)
    return illegal_argument("the problem is given by callbacks; sensitivities need recorded equations.");
  const CallResult checked = read_parameters(solver, count, names, request.parameters);
  if (checked.status != SFDAE_OK) return checked;
  const std::size_t size = index(solver.model.n()) * index(count);
  request.directions.assign(size, 0.0);
  if (directions != nullptr) {
    if (!all_finite(directions, size)) return illegal_argument("directions has entries that are not finite.");
    std::copy_n(directions, size, request.directions.begin());
  }
  return read_sensitivity_options(count, options, request);
}

// At the time of the start: the derivatives of values at a time that moves, less what x' has done since.
std::vector<double> directions_at(const SensitivityRequest& wanted, const std::vector<double>& xdot) {
  std::vector<double> directions = wanted.directions;
  for (std::size_t j = 0; j < wanted.shifts.size(); ++j)
    for (std::size_t i = 0; i < xdot.size(); ++i) directions[i + j * xdot.size()] -= xdot[i] * wanted.shifts[j];
  return directions;
}

std::unique_ptr<Companion> started_companion(sfdae_solver& solver, const ConsistentPoint& found) {
  const std::vector<double>& x = found.x;
  const SensitivityRequest& wanted = *solver.sensitivities;
  std::unique_ptr<SensitivitySystem> system = solver.model.sensitivities(wanted.parameters);
  if (!system)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        "there are no sensitivities of these equations: prescribed components, or linear equations with more or "
        "fewer equations than unknowns.");
  ConsistencyRequest request = solver.options.model.request_at(x.data());
  if (wanted.last_follows && request.kind == InitialValues::accept) {
    request.kind = InitialValues::nearest;
    request.keeps_differentiated = true;
    request.weights.clear();
  }
  std::vector<double> S(wanted.directions.size());
  system->start(request, directions_at(wanted, found.xdot).data(), S.data());
  if (wanted.by_adjoint)
    return std::make_unique<DiscreteAdjoint>(system->adjoint(), std::move(S), wanted.max_kept_steps);
  return std::make_unique<Sensitivities>(std::move(system), wanted.options, std::move(S));
}

}  // namespace

void carry_sensitivities(sfdae_solver& solver, const ConsistentPoint& found) {
  if (!solver.sensitivities) return;
  try {
    solver.integration->carry(started_companion(solver, found));
  } catch (...) {
    solver.integration.reset();
    throw;
  }
}

}  // namespace sfdae::core

using namespace sfdae::core;

namespace {

CallResult no_sensitivities() {
  return {SFDAE_NOT_STARTED, "there are no sensitivities: call sfdae_set_sensitivities and sfdae_start first."};
}

bool has_sensitivities(const sfdae_solver& solver) {
  return solver.integration && solver.integration->sensitivities() != nullptr;
}

}  // namespace

extern "C" {

int sfdae_sensitivity_options_init(sfdae_sensitivity_options* options, size_t size) {
  return initialize(options, size, default_sensitivity_options());
}

int sfdae_sensitivity_statistics_init(sfdae_sensitivity_statistics* statistics, size_t size) {
  return initialize(statistics, size, sfdae_sensitivity_statistics{});
}

int sfdae_set_sensitivities(sfdae_solver* solver, int count, const char* const* parameters, const double* directions,
                            const sfdae_sensitivity_options* options) {
  return guarded(solver, [&]() -> CallResult {
    if (solver->hybrid != nullptr)
      return illegal_argument(
          "the solver is a mode of a hybrid system, which carries sensitivities over its transitions: call "
          "sfdae_set_hybrid_sensitivities.");
    SensitivityRequest request;
    const CallResult checked = read_request(*solver, count, parameters, directions, options, request);
    if (checked.status != SFDAE_OK) return checked;
    take_sensitivities(*solver, count > 0 ? std::optional<SensitivityRequest>(std::move(request)) : std::nullopt);
    return {};
  });
}

int sfdae_get_sensitivities(sfdae_solver* solver, double t, double* S, double* Sdot) {
  return guarded(solver, [&]() -> CallResult {
    if (S == nullptr) return illegal_argument("S is NULL.");
    if (!std::isfinite(t)) return illegal_argument(format("t is %g.", t));
    if (!has_sensitivities(*solver)) return no_sensitivities();
    return solver->integration->evaluate_sensitivities(t, S, Sdot);
  });
}

int sfdae_get_event_sensitivities(sfdae_solver* solver, double t, double g_t, const double* g_x, const double* g_p,
                                  double* dt) {
  return guarded(solver, [&]() -> CallResult {
    if (g_x == nullptr || dt == nullptr) return illegal_argument("g_x and dt must not be NULL.");
    if (!has_sensitivities(*solver)) return no_sensitivities();
    const int n = solver->model.n(), count = solver->integration->sensitivities()->count();
    if (!std::isfinite(t) || !std::isfinite(g_t) || !all_finite(g_x, index(n)) ||
        (g_p != nullptr && !all_finite(g_p, index(count))))
      return illegal_argument("t, g_t, g_x or g_p has entries that are not finite.");
    std::vector<double> S(index(n) * index(count)), x(index(n)), xdot(index(n)), moved(index(count));
    CallResult result = solver->integration->evaluate_sensitivities(t, S.data(), nullptr);
    if (result.status != SFDAE_OK) return result;
    solver->integration->want_slopes(true);
    result = solver->integration->interpolate(t, false, x.data(), xdot.data());
    if (result.status != SFDAE_OK) return result;
    double rate = g_t;
    for (int i = 0; i < n; ++i) rate += g_x[i] * xdot[index(i)];
    for (int j = 0; j < count; ++j) {
      double change = g_p != nullptr ? g_p[j] : 0.0;
      for (int i = 0; i < n; ++i) change += g_x[i] * S[index(i) + index(j) * index(n)];
      moved[index(j)] = -change / rate;
    }
    if (!all_finite(moved.data(), moved.size()))
      return {SFDAE_SINGULAR, format("g does not change with t at t = %.15g: g_t + g_x x' = %.3g.", t, rate)};
    std::copy(moved.begin(), moved.end(), dt);
    return {};
  });
}

int sfdae_get_gradient(sfdae_solver* solver, int num_times, const double* t, int num_functionals,
                       const double* weights, double* gradient) {
  return guarded(solver, [&]() -> CallResult {
    if (t == nullptr || weights == nullptr || gradient == nullptr)
      return illegal_argument("t, weights and gradient must not be NULL.");
    if (solver->hybrid != nullptr)
      return illegal_argument("the solver is a mode of a hybrid system: call sfdae_get_hybrid_gradient.");
    if (!solver->integration || solver->integration->adjoint() == nullptr)
      return {SFDAE_NOT_STARTED,
              "no steps are kept: call sfdae_set_sensitivities with the option adjoint = 1, and sfdae_start, first."};
    const CallResult checked = check_functionals({solver->model.n(), num_times, t, num_functionals, weights});
    if (checked.status != SFDAE_OK) return checked;
    const std::vector<double> times(t, t + num_times);
    return solver->integration->gradient({times, weights, num_functionals}, gradient);
  });
}

int sfdae_get_sensitivity_statistics(const sfdae_solver* solver, sfdae_sensitivity_statistics* statistics) {
  if (solver == nullptr || statistics == nullptr || !is_plausible_size(statistics->size))
    return SFDAE_ILLEGAL_ARGUMENT;
  sfdae_sensitivity_statistics result{};
  if (has_sensitivities(*solver)) {
    const SensitivityWork work = solver->integration->sensitivities()->work();
    result.count = solver->integration->sensitivities()->count();
    result.linearizations = work.linearizations;
    result.factorizations = work.factorizations;
    result.error_test_failures = work.error_failures;
    result.outputs = work.outputs;
  } else if (solver->integration && solver->integration->adjoint() != nullptr) {
    const DiscreteAdjoint& adjoint = *solver->integration->adjoint();
    result.count = adjoint.count() - solver->sensitivities->num_of_values;
    const AdjointWork work = adjoint.work();
    result.kept_steps = work.kept_steps;
    result.kept_bytes = static_cast<double>(work.bytes);
    result.checkpoints = work.checkpoints;
    result.repeated_steps = work.repeated_steps;
  }
  fill_struct(statistics, result);
  return SFDAE_OK;
}

}  // extern "C"
