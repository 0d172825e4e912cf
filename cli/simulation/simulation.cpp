// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/simulation.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "simulation/initial_state.h"
#include "simulation/integration.h"
#include "simulation/preparation.h"
#include "simulation/text.h"

namespace sfdae::cli {

namespace {

constexpr int default_outputs = 500;
// Minimum number of steps if event functions depend on time and unknowns: they are sampled at a few points of each
// step.
constexpr double steps_with_events = 100.0;

Settings resolved(Settings settings, const Experiment& experiment, const FlatModel& model) {
  const auto set = [](double& value, const std::optional<double>& annotated, double otherwise) {
    if (std::isnan(value)) value = annotated.value_or(otherwise);
  };
  set(settings.start, experiment.start, 0.0);
  set(settings.stop, experiment.stop, settings.start + 1.0);
  set(settings.tolerance, experiment.tolerance, 1e-6);
  if (!std::isfinite(settings.start) || !std::isfinite(settings.stop) || settings.stop <= settings.start)
    throw ModelError(
        model.file, {},
        "the stop time " + to_text(settings.stop) + " is not after the start time " + to_text(settings.start));
  if (!(settings.tolerance > 0.0 && settings.tolerance < 1.0))
    throw ModelError(model.file, {}, "the tolerance " + to_text(settings.tolerance) + " is not between 0 and 1");
  const double interval = experiment.interval.value_or(0.0);
  if (settings.num_outputs <= 0)
    settings.num_outputs =
        interval > 0.0 && interval <= settings.stop - settings.start
            ? static_cast<int>(std::min(std::lround((settings.stop - settings.start) / interval), 10000000L))
            : default_outputs;
  return settings;
}

sfdae::Options options_of(const System& system, const Settings& settings, const std::vector<int>& unknowns) {
  sfdae::Options options;
  options.rtol = settings.tolerance;
  options.method = settings.method;
  options.max_index = 12;  // the highest allowed: formulas have all derivatives
  for (int v : unknowns)
    options.atol_vector.push_back(settings.tolerance * (v >= 0 ? system.sizes.nominal[at(v)] : 1.0));
  if (settings.progress)
    options.monitor = [progress = settings.progress](const sfdae::Progress& reached) {
      return !progress(reached.t, reached.step, reached.order);
    };
  bool has_roots = false;
  for (const Switch& it : system.switches) has_roots = has_roots || it.has_root;
  if (has_roots) options.max_step = (settings.stop - settings.start) / steps_with_events;
  return options;
}

std::vector<int> with_free(const System& system) {
  std::vector<int> unknowns = system.unknowns;
  unknowns.insert(unknowns.end(), system.free_parameters.begin(), system.free_parameters.end());
  if (unknowns.empty()) unknowns.push_back(-1);
  return unknowns;
}

// The library's analysis of the last mode, unless it has only the dummy unknown.
void describe(const LibraryCalls& calls, Result& result) {
  if (!calls.last_mode() || calls.last_mode()->has_dummy) return;
  const sfdae::Solver& solver = calls.last_mode()->solver;
  try {
    result.report = calls.translated(solver.report());
    result.decisions = solver.decisions();
    result.characteristics = solver.characteristics();
    result.characteristics.differential -= solver.num_unknowns() - result.num_unknowns;  // free parameters
  } catch (const sfdae::Error&) {                                                        // no analysis
  }
}

// A value given for a variable whose start value is not fixed is only an initial guess; the initial value may differ.
void warn_of_changed_guesses(const System& system, const Parameters& parameters, const Values& values,
                             std::vector<std::string>& warnings) {
  constexpr double relative = 1e-6, of_scale = 1e-9;  // errors of initial values
  for (const auto& [v, given] : parameters.given_starts()) {
    const Variable& variable = system.model.variables[at(v)];
    const double value = values.variable[at(v)];
    const double tolerance =
        relative * std::max(std::fabs(given), std::fabs(value)) + of_scale * system.sizes.scale[at(v)];
    if (std::fabs(value - given) <= tolerance) continue;
    warnings.push_back(
        place(system.model, variable.at) + ": the value " + to_text(given) + " given for " + variable.name +
        (variable.is_fixed ? " was replaced by equations" : " is only a guess, its start value is not fixed") + "; " +
        variable.name + " starts at " + to_text(value));
  }
}

void run(const FlatModel& model, const Settings& settings, bool only_analysis, Result& result) {
  Parameters parameters(model, settings.values, result.warnings);
  const std::unique_ptr<System> system = prepared(model, parameters, result.warnings, settings.reduce_above);
  for (int v = 0; v < static_cast<int>(model.variables.size()); ++v)
    if (parameters.is_known(v)) result.parameters[model.variables[at(v)].name] = parameters.value(v);
  result.num_unknowns = static_cast<int>(system->unknowns.size());
  result.num_eliminated = system->num_eliminated;
  result.num_replaced_states = system->num_replaced_states;
  const std::vector<int> all_unknowns = with_free(*system);
  Modes modes(*system,
              options_of(*system, settings, system->unknowns.empty() ? std::vector<int>{-1} : system->unknowns),
              false);
  Modes initial_modes(*system, options_of(*system, settings, all_unknowns), true);
  LibraryCalls calls(*system, settings);
  calls.set_unknowns(all_unknowns);
  Switches switches(*system, settings.stop - settings.start);
  Discrete discrete(*system);
  EventIteration events(*system, modes, calls, switches, discrete, settings.stop - settings.start, result.warnings);
  Output output(*system, settings.keeps_aliases, discrete, result);
  Values values(*system);
  sfdae::Point point;
  try {
    calls.check_stop(settings.start, 0.0, 0);
    InitialState(*system, initial_modes, calls, switches, discrete).find(settings.start, values, result.warnings);
    warn_of_changed_guesses(*system, parameters, values, result.warnings);
    modes.to_point(values, point);
    const EventResult at_start = events.run_at_start(values, point);
    if (only_analysis) {
      const std::shared_ptr<Mode> mode = modes.at_values(values);
      const int status = calls.run(*mode, Phase::analysis, "index analysis",
                                   [&] { return mode->solver.start(point, settings.stop); });
      if (status == SFDAE_NOT_UNIQUE) result.warnings.push_back(calls.message());
      output.add(values);
    } else if (at_start.is_terminated) {
      output.add(values);
      result.message = at_start.message;
    } else {
      Integration({*system, settings, modes, calls, switches, discrete, events, output, result}).run(values, point);
    }
  } catch (const Failure&) {
    describe(calls, result);
    throw;
  } catch (const sfdae::Error& error) {  // formulas that cannot be recorded in a mode
    describe(calls, result);
    throw Failure(result.trajectory.t.empty() ? Outcome::not_analyzed : Outcome::not_finished, error.status(),
                  "t = " + to_text(values.t) + ": " + calls.translated(error.what()));
  }
  describe(calls, result);
}

Result guarded(const FlatModel& model, const Settings& given, bool only_analysis) {
  Result result;
  sfdae_characteristics_init(&result.characteristics, sizeof result.characteristics);
  sfdae_statistics_init(&result.statistics, sizeof result.statistics);
  const auto fail = [&](Outcome outcome, int status, const char* message) {
    result.outcome = outcome;
    result.status = status;
    result.message = message;
  };
  try {
    run(model, resolved(given, model.experiment, model), only_analysis, result);
  } catch (const Failure& failure) {
    fail(failure.outcome(), failure.status(), failure.what());
  } catch (const ModelError& error) {
    fail(Outcome::invalid_model, SFDAE_OK, error.what());
  } catch (const sfdae::Error& error) {
    fail(Outcome::not_analyzed, error.status(), error.what());
  } catch (const std::bad_alloc&) {
    fail(Outcome::not_analyzed, SFDAE_OUT_OF_MEMORY, "out of memory");
  }
  return result;
}

}  // namespace

Result analyze(const FlatModel& model, const Settings& settings) { return guarded(model, settings, true); }

Result solve(const FlatModel& model, const Settings& settings) { return guarded(model, settings, false); }

}  // namespace sfdae::cli
