// A run across modes: each is entered with the values that its equations make of those before, and left where a
// transition is due.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>

#include "c_api/hybrid.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

void keep_warning(HybridRun& run, CallResult result) {
  if (result.status > 0 && run.warning.status == SFDAE_OK) run.warning = std::move(result);
}

// The transitions of a mode that are events of its solver, in their order; then, of those of switches, which happen
// where their function is 0, what is left to be noticed where a mode begins closely beyond that.
int evaluate_watched(double t, const double* x, const double* xdot, double* g, void* user) {
  const HybridMode& mode = *static_cast<const HybridMode*>(user);
  std::size_t next = mode.watched.size();
  for (std::size_t i = 0; i < mode.watched.size(); ++i) {
    const HybridTransition& transition = (*mode.transitions)[index(mode.watched[i])];
    const sfdae_transition& given = transition.given;
    const int returned = given.function(t, x, xdot, g + i, given.user);
    if (returned != 0) return returned;
    if (transition.surface != nullptr) g[next++] = g[i] - transition.margin;
    else if (given.kind == SFDAE_TRANSITION_CONDITION) g[i] -= transition.margin;
  }
  return 0;
}

void record_in(sfdae_hybrid& hybrid, int mode) {
  for (HybridMode& other : hybrid.modes) {
    if (&other == &hybrid.modes[index(mode)] || other.solver->solution.expired()) continue;
    other.solver->solution.reset();
    if (other.solver->integration) other.solver->integration->record({});
  }
  if (!hybrid.solution.expired()) hybrid.modes[index(mode)].solver->solution = hybrid.solution;
}

// From run.t, run.x.
CallResult enter(sfdae_hybrid& hybrid, int to) {
  HybridRun& run = hybrid.run;
  run.mode = -1;
  record_in(hybrid, to);
  take_options_of_modes(hybrid, to);
  CallResult result;
  for (const int k : hybrid.modes[index(to)].watched) {
    HybridTransition& transition = hybrid.transitions[index(k)];
    result = find_margin(hybrid, transition.given, transition.margin);
    if (result.status < 0) return result;
  }
  begin_sensitivities(hybrid, to);
  result = with_analysis(hybrid, to, run.x.data(), [&](sfdae_solver* solver) {
    return sfdae_start(solver, run.t, toward_from(run), run.x.data(), run.xdot.data());
  });
  end_sensitivities(hybrid, to);
  if (result.status < 0) return result;
  keep_warning(run, std::move(result));
  run.mode = to;
  run.entered = run.t;
  run.is_fresh = true;
  run.short_time = time_of_short_visit(run, hybrid.modes[index(to)].solver->options.model.tolerances);
  run.integration = hybrid.modes[index(to)].solver->integration.get();
  ++hybrid.modes[index(to)].left.visits;
  return {};
}

void leave(sfdae_hybrid& hybrid) {
  HybridRun& run = hybrid.run;
  HybridMode& mode = hybrid.modes[index(run.mode)];
  mode.left.add(statistics_of(*mode.solver));
  mode.left.duration += run.t - run.entered;
  run.integration = nullptr;
}

// Largest in size; -1 where all are 0.
std::pair<double, int> largest_of(const std::vector<double>& values) {
  std::pair<double, int> largest(0.0, -1);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::fabs(values[i]) > largest.first) largest = {std::fabs(values[i]), static_cast<int>(i)};
  return largest;
}

CallResult find_values_after(sfdae_hybrid& hybrid, const sfdae_transition& given) {
  HybridRun& run = hybrid.run;
  run.after = run.before = run.x;
  run.impulse.assign(run.x.size(), 0.0);
  if (given.jump == nullptr)
    return with_analysis(hybrid, given.to, run.before.data(), [&](sfdae_solver* solver) {
      return sfdae_jump(solver, run.t, toward_from(run), run.before.data(), run.after.data(), 1, run.impulse.data());
    });
  const int returned = given.jump(run.t, given.from, given.to, run.before.data(), run.after.data(), given.user);
  if (returned != 0) return of_callback("jump", run, returned);
  if (!all_finite(run.after.data(), run.after.size()))
    return {SFDAE_NOT_FINITE, format("jump wrote NaN or Inf at t = %.10g, from %s to %s.", run.t,
                                     hybrid.name_of(given.from).c_str(), hybrid.name_of(given.to).c_str())};
  return {};
}

// Whether it is one of a mode: out of it, or out of one of the two between which it slides, but for those of their
// switch.
bool leads_out_of(const HybridTransition& transition, const sfdae_hybrid& hybrid, int mode) {
  const Switch* along = hybrid.modes[index(mode)].surface;
  const int from = transition.given.from;
  if (from == mode) return true;
  return along != nullptr && along != transition.surface &&
         (from == along->modes().below || from == along->modes().above);
}

void list_transitions(sfdae_hybrid& hybrid) {
  for (int mode = 0; mode < static_cast<int>(hybrid.modes.size()); ++mode) {
    HybridMode& its = hybrid.modes[index(mode)];
    its.watched.clear();
    its.timed.clear();
    its.needs_slopes = false;
    for (int k = 0; k < static_cast<int>(hybrid.transitions.size()); ++k) {
      const HybridTransition& transition = hybrid.transitions[index(k)];
      if (!leads_out_of(transition, hybrid, mode)) continue;
      (transition.given.kind == SFDAE_TRANSITION_TIME ? its.timed : its.watched).push_back(k);
      its.needs_slopes = its.needs_slopes || transition.given.guard != nullptr || transition.surface != nullptr;
    }
  }
}

// at_once: where the mode begins.
CallResult go_over(sfdae_hybrid& hybrid, int number, bool at_once) {
  HybridRun& run = hybrid.run;
  HybridTransition& transition = hybrid.transitions[index(number)];
  sfdae_transition given = transition.given;
  given.from = run.mode;
  const std::vector<double> before = run.x;
  CallResult result = find_shifts(hybrid, transition, at_once);
  count_short_visit(run);
  leave(hybrid);
  if (result.status >= 0) keep_visit(hybrid, at_once);
  if (result.status >= 0)
    result =
        transition.surface != nullptr ? choose_mode(hybrid, transition, given.to) : prepare_sliding(hybrid, given.to);
  if (result.status >= 0) result = find_values_after(hybrid, given);
  if (result.status >= 0) {
    CallResult carried = carry_over(hybrid, given);
    if (carried.status < 0) result = std::move(carried);
  }
  if (result.status >= 0) {
    keep_warning(run, std::move(result));
    run.x = run.after;
    result = enter(hybrid, given.to);
  }
  if (result.status < 0) {
    run.mode = -1;
    run.x = before;
    return result;
  }
  run.after = run.x;
  std::vector<double> change(run.x.begin(), run.x.begin() + hybrid.n());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= run.before[i];
  const auto [impulse, where] = largest_of({run.impulse.begin(), run.impulse.begin() + hybrid.n()});
  const auto [largest, changed] = largest_of(change);
  run.passages.push_back(
      {sizeof(sfdae_passage), run.t, number, given.from, given.to, impulse, where, largest, changed});
  note_passage(transition, run.t);
  return check_accumulation(hybrid, transition);
}

// Where memory is missing the integration ends, too: going on it would miss the transition.
CallResult pass(sfdae_hybrid& hybrid, int number, bool at_once) {
  try {
    return go_over(hybrid, number, at_once);
  } catch (...) {
    hybrid.run.mode = -1;
    throw;
  }
}

// Whether the guard, if there is one, is > 0 at the point reached.
CallResult ask_guard(const HybridRun& run, const sfdae_transition& given, bool& is_open) {
  double value = 1.0;
  const int returned =
      given.guard != nullptr ? given.guard(run.t, run.x.data(), run.xdot.data(), &value, given.user) : 0;
  is_open = value > 0.0;
  return returned != 0 ? of_callback("guard", run, returned) : CallResult{};
}

// The first condition that holds where the mode begins; -1: none. Those that do not hold count from now on where they
// have risen clearly above the value that they have here: so their sign is known where the mode begins, and one that
// is zero here counts if it rises.
CallResult find_condition(sfdae_hybrid& hybrid, int& number) {
  const HybridRun& run = hybrid.run;
  const HybridMode& mode = hybrid.mode();
  number = -1;
  for (const int k : mode.watched) {
    const sfdae_transition& given = hybrid.transitions[index(k)].given;
    if (given.kind != SFDAE_TRANSITION_CONDITION) continue;
    double value = 0.0;
    const int returned = given.function(run.t, run.x.data(), run.xdot.data(), &value, given.user);
    if (returned != 0) return of_callback(name_of_function(given), run, returned);
    double& margin = hybrid.transitions[index(k)].margin;
    if (!(value > margin)) {
      if (value > 0.0) margin += value;
      continue;
    }
    bool is_open = false;
    CallResult asked = ask_guard(run, given, is_open);
    if (asked.status != SFDAE_OK) return asked;
    if (!is_open) continue;
    number = k;
    return {};
  }
  return {};
}

// The first transition that is due at the point reached: among those watched that happened, or at this time.
CallResult find_due(const sfdae_hybrid& hybrid, bool is_event, int& number) {
  const HybridRun& run = hybrid.run;
  const HybridMode& mode = hybrid.mode();
  number = -1;
  std::vector<int> due;
  if (is_event) {
    const std::vector<int>& fired = mode.solver->events->search.fired();
    std::size_t next = mode.watched.size();
    for (std::size_t i = 0; i < mode.watched.size(); ++i) {
      const bool is_of_switch = hybrid.transitions[index(mode.watched[i])].surface != nullptr;
      if (fired[i] != 0 || (is_of_switch && fired[next] != 0)) due.push_back(mode.watched[i]);
      if (is_of_switch) ++next;
    }
  }
  for (const int k : mode.timed)
    if (hybrid.transitions[index(k)].given.time == run.t && run.t != run.entered) due.push_back(k);
  std::sort(due.begin(), due.end());
  for (const int k : due) {
    bool is_open = false;
    CallResult asked = ask_guard(run, hybrid.transitions[index(k)].given, is_open);
    if (asked.status != SFDAE_OK) return asked;
    if (!is_open) continue;
    number = k;
    return {};
  }
  return {};
}

double next_target(const sfdae_hybrid& hybrid, double tout) {
  const HybridRun& run = hybrid.run;
  for (const int k : hybrid.mode().timed) {
    const double time = hybrid.transitions[index(k)].given.time;
    if ((time - run.t) * run.direction() > 0.0 && (tout - time) * run.direction() > 0.0) tout = time;
  }
  return tout;
}

// Conditions that hold where modes begin, one after the other.
CallResult leave_at_once(sfdae_hybrid& hybrid, bool only_once, bool& has_left) {
  has_left = false;
  while (hybrid.run.is_fresh) {
    int number = -1;
    CallResult result = find_condition(hybrid, number);
    if (result.status < 0) return result;
    hybrid.run.is_fresh = false;
    if (number < 0) break;
    result = pass(hybrid, number, true);
    has_left = true;
    if (result.status < 0 || only_once) return result;
  }
  return {};
}

}  // namespace

CallResult of_mode(const sfdae_hybrid& hybrid, int mode, int status) {
  const char* said = sfdae_message(hybrid.modes[index(mode)].solver);
  return {status, *said != '\0' ? hybrid.name_of(mode) + ": " + said : std::string()};
}

CallResult with_analysis(sfdae_hybrid& hybrid, int to, const double* x,
                         const std::function<int(sfdae_solver*)>& call) {
  HybridMode& mode = hybrid.modes[index(to)];
  const HybridRun& run = hybrid.run;
  const bool had_analysis = mode.solver->system() != nullptr;
  hybrid.running.store(mode.solver);
  int status = call(mode.solver);
  if (!had_analysis && mode.solver->system() != nullptr) ++mode.num_analyses;
  if (had_analysis && status == SFDAE_CHARACTERISTICS_CHANGED) {
    ++mode.num_analyses;
    status = sfdae_analyze_at(mode.solver, run.t, toward_from(run), x, nullptr);
    if (status >= 0) status = call(mode.solver);
  }
  return of_mode(hybrid, to, status);
}

void VisitCounts::add(const sfdae_statistics& s) {
  steps += s.steps;
  error_failures += s.error_failures;
  other_failures += s.other_failures;
  reductions += s.reductions;
  factorizations += s.factorizations;
  if (s.smallest_kept > 0.0)
    smallest_kept = smallest_kept > 0.0 ? std::min(smallest_kept, s.smallest_kept) : s.smallest_kept;
  consistency = std::max(consistency, s.consistency);
  rounding = std::max(rounding, s.rounding);
}

VisitCounts counts_of(const sfdae_hybrid& hybrid, int mode) {
  VisitCounts counts = hybrid.modes[index(mode)].left;
  if (mode != hybrid.run.mode) return counts;
  counts.add(statistics_of(*hybrid.modes[index(mode)].solver));
  counts.duration += hybrid.run.t - hybrid.run.entered;
  return counts;
}

CallResult set_events_of(sfdae_hybrid& hybrid, int k) {
  HybridMode& mode = hybrid.modes[index(k)];
  std::vector<int> directions;
  for (const int number : mode.watched) {
    const sfdae_transition& given = hybrid.transitions[index(number)].given;
    directions.push_back(given.kind == SFDAE_TRANSITION_CONDITION ? 1 : given.direction);
  }
  for (const int number : mode.watched)
    if (hybrid.transitions[index(number)].surface != nullptr) directions.push_back(1);
  const int status =
      sfdae_set_events(mode.solver, static_cast<int>(directions.size()), evaluate_watched, directions.data(), &mode);
  if (mode.solver->events) {
    EventSearch& search = mode.solver->events->search;
    for (std::size_t i = 0; i < mode.watched.size(); ++i)
      if (hybrid.transitions[index(mode.watched[i])].given.kind == SFDAE_TRANSITION_CONDITION)
        search.set_clear_at_start(i);
  }
  // With sensitivities no function may depend on x'.
  if (mode.solver->events) mode.solver->events->tries_without_slopes = hybrid.sensitivities.has_value();
  return status < 0 ? of_mode(hybrid, k, status) : CallResult{};
}

CallResult set_transition_events(sfdae_hybrid& hybrid) {
  if (!hybrid.events_are_set) list_transitions(hybrid);
  for (int k = 0; k < static_cast<int>(hybrid.modes.size()) && !hybrid.events_are_set; ++k) {
    CallResult result = set_events_of(hybrid, k);
    if (result.status < 0) return result;
  }
  hybrid.events_are_set = true;
  // Set before with sensitivities, or without.
  for (HybridMode& mode : hybrid.modes)
    if (mode.solver->events) mode.solver->events->tries_without_slopes = hybrid.sensitivities.has_value();
  return {};
}

CallResult start_run(sfdae_hybrid& hybrid, int mode, const PointOfInterest& point) {
  CallResult result = update_switches(hybrid);
  if (result.status >= 0) result = ask_for_sensitivities(hybrid);
  if (result.status >= 0) result = set_transition_events(hybrid);
  if (result.status < 0) return result;
  const std::size_t n = index(hybrid.n());
  HybridRun run;
  run.start = run.entered = run.t = point.t;
  run.toward = point.toward;
  run.x.assign(point.x, point.x + n);
  run.x.resize(index(hybrid.width()), 0.0);
  run.xdot.assign(run.x.size(), 0.0);
  if (point.xdot != nullptr) std::copy_n(point.xdot, n, run.xdot.begin());
  if (hybrid.sensitivities) {
    run.shifts.assign(hybrid.sensitivities->names.size(), 0.0);
    run.moved = directions_at_start(hybrid);
  }
  hybrid.run = std::move(run);
  hybrid.kept = {};
  for (HybridMode& each : hybrid.modes) each.left = {};
  for (HybridTransition& each : hybrid.transitions) each.passages.clear();
  result = prepare_sliding(hybrid, mode);
  if (result.status >= 0) result = enter(hybrid, mode);
  bool has_left = false;
  if (result.status >= 0) result = leave_at_once(hybrid, false, has_left);
  hybrid.running.store(nullptr);
  return result.status < 0 ? result : std::exchange(hybrid.run.warning, {});
}

namespace {

CallResult advance_modes(sfdae_hybrid& hybrid, double tout, bool stops_at_transition, bool wants_slopes) {
  HybridRun& run = hybrid.run;
  run.warning = {};
  CallResult updated = update_switches(hybrid);
  if (updated.status < 0) return updated;
  for (;;) {
    bool has_left = false;
    CallResult result = leave_at_once(hybrid, stops_at_transition, has_left);
    if (result.status < 0) return result;
    if (has_left && stops_at_transition) return {SFDAE_EVENT, ""};
    if (hybrid.stop_is_requested.exchange(false)) return {SFDAE_STOPPED, "stopped by sfdae_request_stop_hybrid."};
    const HybridMode& mode = hybrid.mode();
    const double target = next_target(hybrid, tout);
    double* xdot = wants_slopes || mode.needs_slopes || hybrid.sensitivities ? run.xdot.data() : nullptr;
    hybrid.running.store(mode.solver);
    const int status = sfdae_advance(mode.solver, target, &run.t, run.x.data(), xdot);
    hybrid.running.store(nullptr);
    if (status == SFDAE_STOPPED) hybrid.stop_is_requested.store(false);
    if (status < 0 || status == SFDAE_STOPPED) return of_mode(hybrid, run.mode, status);
    if (status != SFDAE_EVENT) keep_warning(run, of_mode(hybrid, run.mode, status));
    int number = -1;
    result = find_due(hybrid, status == SFDAE_EVENT, number);
    if (result.status < 0) return result;
    if (number >= 0) {
      result = pass(hybrid, number, false);
      if (result.status < 0) return result;
      if (stops_at_transition) return {SFDAE_EVENT, ""};
    } else if (status != SFDAE_EVENT && run.t == tout) {
      return std::exchange(run.warning, {});
    }
  }
}

}  // namespace

// Where memory is missing the run ends: what has happened in the last step would be missed.
CallResult advance_run(sfdae_hybrid& hybrid, double tout, bool stops_at_transition, bool wants_slopes) {
  try {
    CallResult result = advance_modes(hybrid, tout, stops_at_transition, wants_slopes);
    if (result.status == SFDAE_OUT_OF_MEMORY) hybrid.run.mode = -1;
    return result;
  } catch (...) {
    hybrid.run.mode = -1;
    throw;
  }
}

}  // namespace sfdae::core
