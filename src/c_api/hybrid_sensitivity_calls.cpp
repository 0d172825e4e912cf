// Sensitivities of hybrid systems: requests and results.
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

void check_modes(const sfdae_hybrid& hybrid) {
  if (hybrid.modes.empty()) refuse_argument("there are no modes: call sfdae_add_mode first.");
  for (std::size_t k = 0; k < hybrid.modes.size(); ++k)
    if (hybrid.modes[k].solver->model.evaluator() == nullptr)
      refuse_argument(hybrid.name_of(static_cast<int>(k)) +
                      " is given by callbacks; sensitivities need recorded equations.");
}

void read_names(const sfdae_hybrid& hybrid, int count, const char* const* names, HybridSensitivities& wanted) {
  wanted.names.assign(index(count), "");
  for (int j = 0; j < count && names != nullptr; ++j) {
    if (names[j] == nullptr) continue;
    const auto has_it = [&](const HybridMode& mode) {
      return mode.solver->model.evaluator()->find_parameter(names[j]).has_value();
    };
    const auto surface_has_it = [&](const std::unique_ptr<Switch>& each) { return each->has_parameter(names[j]); };
    if (std::none_of(hybrid.modes.begin(), hybrid.modes.end(), has_it) &&
        std::none_of(hybrid.switches.begin(), hybrid.switches.end(), surface_has_it))
      refuse_argument(format("parameters[%d]: there is no parameter \"%.60s\" in any mode or surface.", j, names[j]));
    wanted.names[index(j)] = names[j];
  }
}

void read_wanted(const sfdae_hybrid& hybrid, int count, const char* const* names, const double* directions,
                 const sfdae_sensitivity_options* options, HybridSensitivities& wanted) {
  check_modes(hybrid);
  read_names(hybrid, count, names, wanted);
  const std::size_t size = index(hybrid.n()) * index(count);
  if (directions != nullptr && !all_finite(directions, size))
    refuse_argument("directions has entries that are not finite.");
  wanted.directions.assign(size, 0.0);
  if (directions != nullptr) std::copy_n(directions, size, wanted.directions.begin());
  SensitivityRequest request;
  read_sensitivity_options(count, options, request);
  wanted.by_adjoint = request.by_adjoint;
  wanted.max_kept_steps = request.max_kept_steps;
  wanted.options = std::move(request.options);
}

bool has_sensitivities(const sfdae_hybrid& hybrid) {
  return hybrid.is_running() && hybrid.mode().solver->integration->sensitivities() != nullptr;
}

[[noreturn]] void refuse_without_sensitivities(const sfdae_hybrid& hybrid) {
  if (hybrid.sensitivities && hybrid.sensitivities->by_adjoint)
    throw Failure(SFDAE_NOT_STARTED,
                  "with adjoint = 1 there are gradients in place of S: call sfdae_get_hybrid_gradient.");
  throw Failure(SFDAE_NOT_STARTED,
                "there are no sensitivities: call sfdae_set_hybrid_sensitivities and sfdae_start_hybrid first.");
}

}  // namespace

extern "C" {

int sfdae_set_hybrid_sensitivities(sfdae_hybrid* hybrid, int count, const char* const* parameters,
                                   const double* directions, const sfdae_sensitivity_options* options) {
  return guarded(hybrid, [&] {
    if (count < 0 || count > most_sensitivities)
      refuse_argument(format("count = %d; it must be 0 ... %d.", count, most_sensitivities));
    std::optional<HybridSensitivities> wanted;
    if (count > 0) {
      read_wanted(*hybrid, count, parameters, directions, options, wanted.emplace());
    }
    hybrid->set_sensitivities(std::move(wanted));
  });
}

int sfdae_get_hybrid_sensitivities(sfdae_hybrid* hybrid, double t, double* S, double* Sdot) {
  return guarded(hybrid, [&] {
    if (!has_sensitivities(*hybrid)) refuse_without_sensitivities(*hybrid);
    if (S == nullptr) refuse_argument("S is NULL.");
    if (!std::isfinite(t)) refuse_argument(format("t is %g.", t));
    hybrid->evaluate_sensitivities(t, S, Sdot);
  });
}

int sfdae_get_passage_sensitivities(sfdae_hybrid* hybrid, double* dt) {
  return guarded(hybrid, [&] {
    if (dt == nullptr) refuse_argument("dt is NULL.");
    if (!has_sensitivities(*hybrid)) refuse_without_sensitivities(*hybrid);
    const HybridRun& run = hybrid->run;
    if (run.passages.count() == 0) throw Failure(SFDAE_NOT_STARTED, "there was no transition since the start.");
    std::copy(run.moving.shifts.begin(), run.moving.shifts.end(), dt);
  });
}

int sfdae_get_hybrid_gradient(sfdae_hybrid* hybrid, int num_times, const double* t, int num_functionals,
                              const double* weights, double* gradient) {
  return guarded(hybrid, [&] {
    if (t == nullptr || weights == nullptr || gradient == nullptr)
      refuse_argument("t, weights and gradient must not be NULL.");
    if (!hybrid->is_running() || hybrid->mode().solver->integration->adjoint() == nullptr)
      throw Failure(SFDAE_NOT_STARTED,
                    "no steps are kept: call sfdae_set_hybrid_sensitivities with the option adjoint = 1, and "
                    "sfdae_start_hybrid, first.");
    check_functionals({hybrid->n(), num_times, t, num_functionals, weights});
    hybrid->gradient({num_times, t, num_functionals, weights}, gradient);
  });
}

}  // extern "C"
