// Sensitivities of hybrid systems: what is asked for, and returned.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>

#include "c_api/hybrid.h"
#include "c_api/sensitivities.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

using namespace sfdae::core;

namespace {

CallResult check_modes(const sfdae_hybrid& hybrid) {
  if (hybrid.modes.empty()) return illegal_argument("there are no modes: call sfdae_add_mode first.");
  for (std::size_t k = 0; k < hybrid.modes.size(); ++k)
    if (hybrid.modes[k].solver->model.evaluator() == nullptr)
      return illegal_argument(hybrid.name_of(static_cast<int>(k)) +
                              " is given by callbacks; sensitivities need recorded equations.");
  return {};
}

CallResult read_names(const sfdae_hybrid& hybrid, int count, const char* const* names, HybridSensitivities& wanted) {
  wanted.names.assign(index(count), "");
  for (int j = 0; j < count && names != nullptr; ++j) {
    if (names[j] == nullptr) continue;
    const auto has_it = [&](const HybridMode& mode) {
      return mode.solver->model.evaluator()->find_parameter(names[j]).has_value();
    };
    const auto surface_has_it = [&](const std::unique_ptr<Switch>& each) { return each->has_parameter(names[j]); };
    if (std::none_of(hybrid.modes.begin(), hybrid.modes.end(), has_it) &&
        std::none_of(hybrid.switches.begin(), hybrid.switches.end(), surface_has_it))
      return illegal_argument(
          format("parameters[%d]: there is no parameter \"%.60s\" in any mode or surface.", j, names[j]));
    wanted.names[index(j)] = names[j];
  }
  return {};
}

CallResult read_wanted(const sfdae_hybrid& hybrid, int count, const char* const* names, const double* directions,
                       const sfdae_sensitivity_options* options, HybridSensitivities& wanted) {
  CallResult checked = check_modes(hybrid);
  if (checked.status == SFDAE_OK) checked = read_names(hybrid, count, names, wanted);
  if (checked.status != SFDAE_OK) return checked;
  const std::size_t size = index(hybrid.n()) * index(count);
  if (directions != nullptr && !all_finite(directions, size))
    return illegal_argument("directions has entries that are not finite.");
  wanted.directions.assign(size, 0.0);
  if (directions != nullptr) std::copy_n(directions, size, wanted.directions.begin());
  SensitivityRequest request;
  checked = read_sensitivity_options(count, options, request);
  if (checked.status != SFDAE_OK) return checked;
  wanted.by_adjoint = request.by_adjoint;
  wanted.max_kept_steps = request.max_kept_steps;
  wanted.options = std::move(request.options);
  return {};
}

bool has_sensitivities(const sfdae_hybrid& hybrid) {
  return hybrid.is_running() && hybrid.mode().solver->integration->sensitivities() != nullptr;
}

CallResult no_sensitivities(const sfdae_hybrid& hybrid) {
  if (hybrid.sensitivities && hybrid.sensitivities->by_adjoint)
    return {SFDAE_NOT_STARTED, "with adjoint = 1 there are gradients in place of S: call sfdae_get_hybrid_gradient."};
  return {SFDAE_NOT_STARTED,
          "there are no sensitivities: call sfdae_set_hybrid_sensitivities and sfdae_start_hybrid first."};
}

}  // namespace

extern "C" {

int sfdae_set_hybrid_sensitivities(sfdae_hybrid* hybrid, int count, const char* const* parameters,
                                   const double* directions, const sfdae_sensitivity_options* options) {
  return guarded(hybrid, [&]() -> CallResult {
    if (count < 0 || count > most_sensitivities)
      return illegal_argument(format("count = %d; it must be 0 ... %d.", count, most_sensitivities));
    std::optional<HybridSensitivities> wanted;
    if (count > 0) {
      const CallResult checked = read_wanted(*hybrid, count, parameters, directions, options, wanted.emplace());
      if (checked.status != SFDAE_OK) return checked;
    }
    hybrid->set_sensitivities(std::move(wanted));
    return {};
  });
}

int sfdae_get_hybrid_sensitivities(sfdae_hybrid* hybrid, double t, double* S, double* Sdot) {
  return guarded(hybrid, [&]() -> CallResult {
    if (!has_sensitivities(*hybrid)) return no_sensitivities(*hybrid);
    if (S == nullptr) return illegal_argument("S is NULL.");
    if (!std::isfinite(t)) return illegal_argument(format("t is %g.", t));
    hybrid->evaluate_sensitivities(t, S, Sdot);
    return {};
  });
}

int sfdae_get_passage_sensitivities(sfdae_hybrid* hybrid, double* dt) {
  return guarded(hybrid, [&]() -> CallResult {
    if (dt == nullptr) return illegal_argument("dt is NULL.");
    if (!has_sensitivities(*hybrid)) return no_sensitivities(*hybrid);
    const HybridRun& run = hybrid->run;
    if (run.passages.count() == 0) return {SFDAE_NOT_STARTED, "there was no transition since the start."};
    std::copy(run.moving.shifts.begin(), run.moving.shifts.end(), dt);
    return {};
  });
}

int sfdae_get_hybrid_gradient(sfdae_hybrid* hybrid, int num_times, const double* t, int num_functionals,
                              const double* weights, double* gradient) {
  return guarded(hybrid, [&]() -> CallResult {
    if (t == nullptr || weights == nullptr || gradient == nullptr)
      return illegal_argument("t, weights and gradient must not be NULL.");
    if (!hybrid->is_running() || hybrid->mode().solver->integration->adjoint() == nullptr)
      return {SFDAE_NOT_STARTED,
              "no steps are kept: call sfdae_set_hybrid_sensitivities with the option adjoint = 1, and "
              "sfdae_start_hybrid, first."};
    const CallResult checked = check_functionals({hybrid->n(), num_times, t, num_functionals, weights});
    if (checked.status != SFDAE_OK) return checked;
    hybrid->gradient({num_times, t, num_functionals, weights}, gradient);
    return {};
  });
}

}  // extern "C"
