// Ensembles: the C API, its checks and its summary.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "c_api/solver.h"
#include "c_api/structs.h"
#include "ensemble/ensemble_run.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

constexpr int most_threads = 1024;

sfdae_ensemble default_ensemble() {
  sfdae_ensemble ensemble{};
  ensemble.size = sizeof ensemble;
  return ensemble;
}

sfdae_ensemble_results default_results() {
  sfdae_ensemble_results results{};
  results.size = sizeof results;
  return results;
}

void check_counts(const sfdae_ensemble& ensemble) {
  if (ensemble.num_instances < 0)
    refuse_argument(format("num_instances = %d; it must be >= 0.", ensemble.num_instances));
  if (ensemble.num_threads < 0 || ensemble.num_threads > most_threads)
    refuse_argument(format("num_threads = %d; it must be 0 ... %d.", ensemble.num_threads, most_threads));
  if (ensemble.num_parameters < 0)
    refuse_argument(format("num_parameters = %d; it must be >= 0.", ensemble.num_parameters));
  if (ensemble.num_times < 1) refuse_argument(format("num_times = %d; it must be >= 1.", ensemble.num_times));
  if (ensemble.times == nullptr) refuse_argument("times is NULL.");
}

void check_times(const sfdae_ensemble& ensemble, const IntegrationOptions& options) {
  const double last = ensemble.times[ensemble.num_times - 1];
  if (!std::isfinite(ensemble.t0) || !std::isfinite(last) || last == ensemble.t0)
    refuse_argument(format("t0 = %g and the last time, %g, must be finite and different.", ensemble.t0, last));
  const double direction = last < ensemble.t0 ? -1.0 : 1.0;
  for (int k = 0; k < ensemble.num_times; ++k) {
    const double t = ensemble.times[k], before = k > 0 ? ensemble.times[k - 1] : ensemble.t0;
    const double advance = (t - before) * direction;
    if (!std::isfinite(t) || advance < 0.0 || (advance == 0.0 && k > 0))
      refuse_argument(format("times[%d] = %.15g does not lie beyond %.15g, toward %.15g.", k, t, before, last));
  }
  if (options.stop_time && (*options.stop_time - last) * direction < 0.0)
    refuse_argument(format("the last time, %.15g, lies beyond stop_time = %.15g.", last, *options.stop_time));
}

void check_parameters(const sfdae_ensemble& ensemble, TaylorEvaluator& evaluator, std::vector<int>& indices) {
  const int count = ensemble.num_parameters;
  if (count > 0 && (ensemble.parameter_names == nullptr || ensemble.parameters == nullptr))
    refuse_argument("num_parameters > 0, but parameter_names or parameters is NULL.");
  std::vector<char> seen(index(evaluator.num_parameters()), 0);
  for (int k = 0; k < count; ++k) {
    const char* const name = ensemble.parameter_names[k];
    if (name == nullptr) refuse_argument(format("parameter_names[%d] is NULL.", k));
    const auto found = evaluator.find_parameter(name);
    if (!found) refuse_argument(format("there is no parameter \"%.60s\" in the equations.", name));
    if (seen[index(*found)] != 0) refuse_argument(format("the parameter \"%.60s\" is named twice.", name));
    seen[index(*found)] = 1;
    indices.push_back(*found);
  }
}

void check_arrays(const sfdae_ensemble& ensemble, const sfdae_ensemble_results& results) {
  if (results.messages != nullptr && results.message_length < 1)
    refuse_argument("messages is set, but message_length is 0.");
  if (ensemble.num_instances == 0) return;
  if (results.messages != nullptr &&
      results.message_length > std::numeric_limits<std::size_t>::max() / index(ensemble.num_instances))
    refuse_argument("message_length is more than memory has for num_instances messages.");
  if (ensemble.x0 == nullptr) refuse_argument("x0 is NULL.");
  if (results.x == nullptr || results.statuses == nullptr) refuse_argument("x or statuses of the results is NULL.");
}

void check_ensemble(sfdae_solver& solver, const sfdae_ensemble& ensemble, const sfdae_ensemble_results& results,
                    std::vector<int>& parameters) {
  TaylorEvaluator* const evaluator = solver.model.evaluator();
  if (evaluator == nullptr)
    refuse_argument("the problem is given by callbacks; an ensemble needs recorded equations.");
  if (solver.events != nullptr)
    refuse_argument("ensembles do not search events: call sfdae_set_events with num_events = 0 first.");
  check_counts(ensemble);
  check_times(ensemble, solver.options.integration);
  check_parameters(ensemble, *evaluator, parameters);
  check_arrays(ensemble, results);
}

CallResult described(const EnsembleSummary& summary, int num_instances) {
  if (summary.monitor_threw) return {SFDAE_INTERNAL, "an exception came out of the monitor."};
  if (summary.stopped > 0)
    return {SFDAE_STOPPED,
            format("stopped on request: %d of %d instances have not come to their end; the call can be "
                   "repeated.",
                   summary.stopped, num_instances)};
  if (summary.failed == 0) return {};
  return {SFDAE_INSTANCES_FAILED,
          format("%d of %d instances failed, first of all instance %d with %s: ", summary.failed, num_instances,
                 summary.first_failed, sfdae_status_name(summary.failure.status)) +
              summary.failure.message};
}

// Results are written and must not be lost if there is no memory for a message. Short strings need no memory.
CallResult result_of(const EnsembleSummary& summary, int num_instances) {
  try {
    return described(summary, num_instances);
  } catch (const std::bad_alloc&) {
    return {summary.monitor_threw ? SFDAE_INTERNAL
            : summary.stopped > 0 ? SFDAE_STOPPED
                                  : SFDAE_INSTANCES_FAILED,
            "see statuses"};
  }
}

CallResult solve(sfdae_solver& solver, const sfdae_ensemble* ensemble, sfdae_ensemble_results* results) {
  if (ensemble == nullptr || !is_plausible_size(ensemble->size))
    refuse_argument("ensemble is NULL or its size is not set: call sfdae_ensemble_init.");
  if (results == nullptr || !is_plausible_size(results->size))
    refuse_argument("results is NULL or its size is not set: call sfdae_ensemble_results_init.");
  const sfdae_ensemble given = read_struct(*ensemble, default_ensemble());
  sfdae_ensemble_results to = read_struct(*results, default_results());
  EnsembleTask task{given, to, {}};
  check_ensemble(solver, given, to, task.parameters);
  const EnsembleSummary summary = given.num_instances > 0 ? solve_ensemble(solver, task) : EnsembleSummary{};
  to.num_failed = summary.failed;
  to.num_analyses = summary.analyses;
  to.num_threads = summary.threads;
  fill_struct(results, to);
  return result_of(summary, given.num_instances);
}

}  // namespace

}  // namespace sfdae::core

using namespace sfdae::core;

extern "C" {

int sfdae_ensemble_init(sfdae_ensemble* ensemble, size_t size) {
  return initialize(ensemble, size, default_ensemble());
}

int sfdae_ensemble_results_init(sfdae_ensemble_results* results, size_t size) {
  return initialize(results, size, default_results());
}

int sfdae_solve_ensemble(sfdae_solver* solver, const sfdae_ensemble* ensemble, sfdae_ensemble_results* results) {
  return guarded(solver, [&] { return solve(*solver, ensemble, results); });
}

}  // extern "C"
