// Sensitivities: the C API.
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

void read_parameters(sfdae_solver& solver, int count, const char* const* names, std::vector<int>& parameters) {
  parameters.assign(index(count), -1);
  for (int j = 0; j < count && names != nullptr; ++j) {
    if (names[j] == nullptr) continue;
    const auto found = solver.model.evaluator()->find_parameter(names[j]);
    if (!found)
      refuse_argument(format("parameters[%d]: there is no parameter \"%.60s\" in the equations.", j, names[j]));
    parameters[index(j)] = *found;
  }
}

}  // namespace

void read_sensitivity_options(int count, const sfdae_sensitivity_options* given, SensitivityRequest& request) {
  SensitivityOptions& options = request.options;
  options.scales.assign(index(count), 1.0);
  if (given == nullptr) return;
  if (!is_plausible_size(given->size))
    refuse_argument("options->size is not set: call sfdae_sensitivity_options_init.");
  const sfdae_sensitivity_options read = read_struct(*given, default_sensitivity_options());
  if (read.error_test != 0 && read.error_test != 1)
    refuse_argument(format("error_test = %d; it must be 0 or 1.", read.error_test));
  if (read.adjoint != 0 && read.adjoint != 1)
    refuse_argument(format("adjoint = %d; it must be 0 or 1.", read.adjoint));
  if (read.adjoint == 1 && read.error_test == 1)
    refuse_argument("error_test = 1 and adjoint = 1 exclude each other: there is no S to be tested then.");
  if (read.max_kept_steps < 0 || read.max_kept_steps == 1)
    refuse_argument(format("max_kept_steps = %ld; it must be 0 or at least 2.", read.max_kept_steps));
  if (read.max_kept_steps > 0 && read.adjoint == 0)
    refuse_argument("max_kept_steps is for adjoint = 1: forward sensitivities keep no steps.");
  request.by_adjoint = read.adjoint == 1;
  request.max_kept_steps = read.max_kept_steps;
  options.error_test = read.error_test == 1;
  for (int j = 0; j < count && read.scales != nullptr; ++j) {
    if (!std::isfinite(read.scales[j]) || read.scales[j] <= 0.0)
      refuse_argument(format("scales[%d] = %g; it must be positive.", j, read.scales[j]));
    options.scales[index(j)] = read.scales[j];
  }
}

void check_functionals(const GivenFunctionals& given) {
  if (given.num_times < 1 || given.num_functionals < 1)
    refuse_argument(format("num_times = %d, num_functionals = %d; both must be positive.", given.num_times,
                           given.num_functionals));
  for (int k = 0; k < given.num_times; ++k)
    if (!std::isfinite(given.t[k])) refuse_argument(format("t[%d] is %g.", k, given.t[k]));
  if (!all_finite(given.weights, index(given.n) * index(given.num_times) * index(given.num_functionals)))
    refuse_argument("weights has entries that are not finite.");
}

namespace {

void read_request(sfdae_solver& solver, int count, const char* const* names, const double* directions,
                  const sfdae_sensitivity_options* options, SensitivityRequest& request) {
  if (count < 0 || count > most_sensitivities)
    refuse_argument(format("count = %d; it must be 0 ... %d.", count, most_sensitivities));
  if (count > 0 && solver.model.evaluator() == nullptr)
    refuse_argument("the problem is given by callbacks; sensitivities need recorded equations.");
  read_parameters(solver, count, names, request.parameters);
  const std::size_t size = index(solver.model.n()) * index(count);
  request.directions.assign(size, 0.0);
  if (directions != nullptr) {
    if (!all_finite(directions, size)) refuse_argument("directions has entries that are not finite.");
    std::copy_n(directions, size, request.directions.begin());
  }
  return read_sensitivity_options(count, options, request);
}

}  // namespace

}  // namespace sfdae::core

using namespace sfdae::core;

namespace {

[[noreturn]] void refuse_without_sensitivities() {
  throw Failure(SFDAE_NOT_STARTED, "there are no sensitivities: call sfdae_set_sensitivities and sfdae_start first.");
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
  return guarded(solver, [&] {
    if (solver->hybrid != nullptr)
      refuse_argument(
          "the solver is a mode of a hybrid system, which carries sensitivities over its transitions: call "
          "sfdae_set_hybrid_sensitivities.");
    SensitivityRequest request;
    read_request(*solver, count, parameters, directions, options, request);
    solver->ask_for_sensitivities(count > 0 ? std::optional<SensitivityRequest>(std::move(request)) : std::nullopt);
  });
}

int sfdae_get_sensitivities(sfdae_solver* solver, double t, double* S, double* Sdot) {
  return guarded(solver, [&]() -> CallResult {
    if (S == nullptr) refuse_argument("S is NULL.");
    if (!std::isfinite(t)) refuse_argument(format("t is %g.", t));
    if (!has_sensitivities(*solver)) refuse_without_sensitivities();
    return solver->integration->evaluate_sensitivities(t, S, Sdot);
  });
}

int sfdae_get_event_sensitivities(sfdae_solver* solver, double t, double g_t, const double* g_x, const double* g_p,
                                  double* dt) {
  return guarded(solver, [&]() -> CallResult {
    if (g_x == nullptr || dt == nullptr) refuse_argument("g_x and dt must not be NULL.");
    if (!has_sensitivities(*solver)) refuse_without_sensitivities();
    const int n = solver->model.n(), count = solver->integration->sensitivities()->count();
    if (!std::isfinite(t) || !std::isfinite(g_t) || !all_finite(g_x, index(n)) ||
        (g_p != nullptr && !all_finite(g_p, index(count))))
      refuse_argument("t, g_t, g_x or g_p has entries that are not finite.");
    return solver->differentiate_event({t, g_t, g_x, g_p}, dt);
  });
}

int sfdae_get_gradient(sfdae_solver* solver, int num_times, const double* t, int num_functionals,
                       const double* weights, double* gradient) {
  return guarded(solver, [&]() -> CallResult {
    if (t == nullptr || weights == nullptr || gradient == nullptr)
      refuse_argument("t, weights and gradient must not be NULL.");
    if (solver->hybrid != nullptr)
      refuse_argument("the solver is a mode of a hybrid system: call sfdae_get_hybrid_gradient.");
    if (!solver->integration || solver->integration->adjoint() == nullptr)
      throw Failure(
          SFDAE_NOT_STARTED,
          "no steps are kept: call sfdae_set_sensitivities with the option adjoint = 1, and sfdae_start, first.");
    check_functionals({solver->model.n(), num_times, t, num_functionals, weights});
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
