// Worker of an ensemble: solves instances one after the other.
// SPDX-License-Identifier: BSD-3-Clause
#include "ensemble/ensemble_worker.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include "linalg/index.h"
#include "solver/status_of.h"

namespace sfdae::core {

namespace {

// The monitor and the events of the prototype do not apply to instances.
SolverOptions options_of_instances(const Solver& prototype) {
  SolverOptions options = prototype.options;
  options.integration.monitor = nullptr;
  options.integration.events = nullptr;
  options.model.for_sensitivities = options.model.for_adjoint = false;
  return options;
}

// True for failures that wrong ranks may have caused: failures of the structure, of values or of steps.
bool may_be_about_ranks(int status) { return status <= SFDAE_INDEX_TOO_HIGH && status != SFDAE_MAX_STEPS; }

void say(InstanceOutcome& outcome, int status, const char* message, const char* hint = "") {
  outcome.status = status;
  std::snprintf(outcome.message, sizeof outcome.message, "%s%s", message, *message != '\0' ? hint : "");
}

}  // namespace

EnsembleWorker::EnsembleWorker(Solver& prototype, const EnsembleTask& task)
    : task_(task),
      solver_(prototype.model.clone(), options_of_instances(prototype)),
      x_(index(solver_.model.n())),
      xdot_(index(solver_.model.n())),
      outputs_(x_.size() * index(task.ensemble.num_times)),
      slopes_(task.results.xdot != nullptr ? outputs_.size() : 0) {
  solver_.problem().stop_with(prototype.problem());
  solver_.breakpoints->take_times(*prototype.breakpoints);
  solver_.use_breakpoints(solver_.options);
  solver_.max_passed = prototype.max_passed;
  solver_.use_continuation(solver_.options.integration);
}

bool EnsembleWorker::set_parameters(int instance, InstanceOutcome& outcome) {
  const sfdae_ensemble& ensemble = task_.ensemble;
  const double* const values = ensemble.parameters + index(instance) * index(ensemble.num_parameters);
  solver_.forget_analysis();
  for (int k = 0; k < ensemble.num_parameters; ++k) {
    if (!std::isfinite(values[k])) {
      say(outcome, SFDAE_ILLEGAL_ARGUMENT,
          format("the value of parameter \"%.60s\" is %g.", ensemble.parameter_names[k], values[k]).c_str());
      return false;
    }
    solver_.model.evaluator()->set_parameter(task_.parameters[index(k)], values[k]);
  }
  solver_.model.parameters_changed();
  return true;
}

template <class Body>
bool EnsembleWorker::goes_on_after(Body body, InstanceOutcome& outcome) {
  const int returned = status_of(body, [&](int status, const char* message) {
    const bool is_first = outcome.status == SFDAE_OK || status < 0 || status == SFDAE_STOPPED;
    if (status != SFDAE_OK && is_first) say(outcome, status, message, solver_.hint(status));
    return status;
  });
  if (returned == SFDAE_STOPPED) solver_.problem().take_stop_request();
  return returned >= 0 && returned != SFDAE_STOPPED;
}

void EnsembleWorker::solve_once(int instance, InstanceOutcome& outcome) {
  const sfdae_ensemble& ensemble = task_.ensemble;
  const std::size_t n = x_.size(), first = index(instance) * n;
  if (!set_parameters(instance, outcome)) return;
  std::copy_n(ensemble.x0 + first, n, x_.data());
  if (ensemble.xdot0 != nullptr) std::copy_n(ensemble.xdot0 + first, n, xdot_.data());
  double t = ensemble.t0;
  const double last = ensemble.times[ensemble.num_times - 1];
  double* const guess = ensemble.xdot0 != nullptr ? xdot_.data() : nullptr;
  const bool is_started = goes_on_after([&] { return solver_.start(t, last, x_.data(), guess); }, outcome);
  const bool is_analyzed = solver_.system() != nullptr || may_be_about_ranks(outcome.status);
  if (is_analyzed && !is_precedented()) ++outcome.analyses;
  if (!is_started) return;
  for (int k = 0; k < ensemble.num_times; ++k) {
    double* const xdot = slopes_.empty() ? nullptr : xdot_.data();
    const auto advance = [&] { return solver_.advance(ensemble.times[k], false, t, x_.data(), xdot); };
    if (!goes_on_after(advance, outcome)) return;
    std::copy_n(x_.data(), n, outputs_.data() + index(k) * n);
    if (xdot != nullptr) std::copy_n(xdot, n, slopes_.data() + index(k) * n);
    outcome.outputs = k + 1;
  }
}

void EnsembleWorker::write_outputs(int instance, int count) const {
  const std::size_t first = index(instance) * outputs_.size(), size = index(count) * x_.size();
  std::copy_n(outputs_.data(), size, task_.results.x + first);
  if (!slopes_.empty()) std::copy_n(slopes_.data(), size, task_.results.xdot + first);
}

InstanceOutcome EnsembleWorker::solve(int instance, const Precedent& precedent) noexcept {
  InstanceOutcome outcome;
  try {
    solver_.options.model.precedent = precedent;
    solve_once(instance, outcome);
    // The ranks at one point may be wrong elsewhere. If there is no system, the analysis has failed.
    const bool may_be_precedented = is_precedented() || (solver_.system() == nullptr && precedent.values.mu >= 0);
    if (may_be_about_ranks(outcome.status) && may_be_precedented) {
      const int analyses = outcome.analyses;
      outcome = {};
      outcome.analyses = analyses;
      solver_.options.model.precedent = {};
      solve_once(instance, outcome);
    }
    write_outputs(instance, outcome.outputs);
  } catch (...) {
    outcome.outputs = 0;
    say(outcome, SFDAE_OUT_OF_MEMORY, out_of_memory);
  }
  return outcome;
}

Precedent EnsembleWorker::analyze(int instance) noexcept {
  try {
    const sfdae_ensemble& ensemble = task_.ensemble;
    InstanceOutcome outcome;
    solver_.options.model.precedent = {};
    if (!set_parameters(instance, outcome)) return {};
    const double* const x = ensemble.x0 + index(instance) * x_.size();
    goes_on_after([&] { return solver_.analyze({ensemble.t0, ensemble.times[ensemble.num_times - 1], x}); }, outcome);
    return solver_.system() != nullptr ? precedent_of(solver_.system()->analysis()) : Precedent{};
  } catch (...) {
    return {};
  }
}

}  // namespace sfdae::core
