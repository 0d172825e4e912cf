// Run across modes: each mode starts from the consistent values computed from those before, and ends at a transition.
// SPDX-License-Identifier: BSD-3-Clause
#include "hybrid/hybrid_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hybrid/accumulation.h"
#include "hybrid/hybrid_sensitivities.h"
#include "hybrid/hybrid_system.h"
#include "hybrid/switches.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

void keep_warning(HybridRun& run, CallResult result) {
  if (result.status > 0 && run.warning.status == SFDAE_OK) run.warning = std::move(result);
}

// Event functions of a mode's solver: its watched transitions in order; then, for those of switches, their functions
// less the margin, to detect transitions when a mode begins just beyond the surface.
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

void record_in(HybridSystem& hybrid, int mode) {
  for (HybridMode& other : hybrid.modes)
    if (&other != &hybrid.modes[index(mode)] && !other.solver->solution.expired()) other.solver->record({});
  if (!hybrid.solution.expired()) hybrid.modes[index(mode)].solver->solution = hybrid.solution;
}

// Enters a mode from run.t, run.x.
void enter(HybridSystem& hybrid, int to) {
  HybridRun& run = hybrid.run;
  HybridMode& mode = hybrid.modes[index(to)];
  run.mode = -1;
  record_in(hybrid, to);
  take_options_of_modes(hybrid, to);
  for (const int k : mode.watched) {
    HybridTransition& transition = hybrid.transitions[index(k)];
    transition.margin = margin_of(hybrid, transition.given);
  }
  begin_sensitivities(hybrid, to);
  try {
    keep_warning(run, hybrid.call_with_analysis(to, run.x.data(), [&](Solver& solver) {
      return solver.start(run.t, run.toward_from(), run.x.data(), run.xdot.data());
    }));
  } catch (...) {
    end_sensitivities(hybrid, to);
    throw;
  }
  end_sensitivities(hybrid, to);
  run.mode = to;
  run.visit = {run.t, true, mode.solver->integration.get(),
               time_of_short_visit(run, mode.solver->options.model.tolerances)};
  ++mode.left.visits;
}

void leave(HybridSystem& hybrid) {
  HybridRun& run = hybrid.run;
  HybridMode& mode = hybrid.modes[index(run.mode)];
  if (mode.solver->integration) mode.left.add(mode.solver->integration->counts());
  mode.left.duration += run.t - run.visit.entered;
  run.visit.integration = nullptr;
}

// Largest absolute value and its index; -1 if all are 0.
std::pair<double, int> largest_of(const std::vector<double>& values) {
  std::pair<double, int> largest(0.0, -1);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::fabs(values[i]) > largest.first) largest = {std::fabs(values[i]), static_cast<int>(i)};
  return largest;
}

void find_values_after(HybridSystem& hybrid, const sfdae_transition& given) {
  HybridRun& run = hybrid.run;
  auto& [before, after, impulse] = run.last;
  after = before = run.x;
  impulse.assign(run.x.size(), 0.0);
  if (given.jump == nullptr) {
    const auto jump = [&run](Solver& solver) -> CallResult {
      const Jump found = solver.jump({run.t, run.toward_from(), run.last.before.data()});
      std::copy(found.x.begin(), found.x.end(), run.last.after.begin());
      if (found.impulses.cols() > 0) std::copy_n(found.impulses.data(), found.x.size(), run.last.impulse.begin());
      return {};
    };
    hybrid.call_with_analysis(given.to, before.data(), jump);
    return;
  }
  demand_success("jump", run, given.jump(run.t, given.from, given.to, before.data(), after.data(), given.user));
  if (!all_finite(after.data(), after.size()))
    throw Failure(SFDAE_NOT_FINITE, format("jump wrote NaN or Inf at t = %.10g, from %s to %s.", run.t,
                                           hybrid.name_of(given.from).c_str(), hybrid.name_of(given.to).c_str()));
}

// True if the transition leaves the mode, or, for a sliding mode, one of its two modes, other than by their switch.
bool leads_out_of(const HybridTransition& transition, const HybridSystem& hybrid, int mode) {
  const Switch* along = hybrid.modes[index(mode)].surface;
  const int from = transition.given.from;
  if (from == mode) return true;
  return along != nullptr && along != transition.surface &&
         (from == along->modes().below || from == along->modes().above);
}

void list_transitions(HybridSystem& hybrid) {
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

void note(HybridSystem& hybrid, int number, const sfdae_transition& given) {
  HybridRun& run = hybrid.run;
  run.last.after = run.x;
  std::vector<double> change(run.x.begin(), run.x.begin() + hybrid.n());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= run.last.before[i];
  const auto [impulse, where] = largest_of({run.last.impulse.begin(), run.last.impulse.begin() + hybrid.n()});
  const auto [largest, changed] = largest_of(change);
  run.passages.known.push_back(
      {sizeof(sfdae_passage), run.t, number, given.from, given.to, impulse, where, largest, changed});
  note_passage(hybrid.transitions[index(number)], run.t);
}

// at_once: the mode has just begun. After a failure the run has ended; continuing would miss the transition.
void go_over(HybridSystem& hybrid, int number, bool at_once) {
  HybridRun& run = hybrid.run;
  HybridTransition& transition = hybrid.transitions[index(number)];
  sfdae_transition given = transition.given;
  given.from = run.mode;
  std::vector<double> before = run.x;
  try {
    find_shifts(hybrid, transition, at_once);
    count_short_visit(run);
    leave(hybrid);
    keep_visit(hybrid, at_once);
    if (transition.surface != nullptr) given.to = mode_after(hybrid, transition, given.to);
    else prepare_sliding(hybrid, given.to);
    find_values_after(hybrid, given);
    carry_over(hybrid, given);
    run.x = run.last.after;
    enter(hybrid, given.to);
    note(hybrid, number, given);
  } catch (...) {
    if (run.visit.integration != nullptr) leave(hybrid);
    run.mode = -1;
    run.x.swap(before);
    throw;
  }
  check_accumulation(hybrid, transition);
}

// True if there is no guard, or it is > 0 at the point reached.
bool is_open(const HybridRun& run, const sfdae_transition& given) {
  if (given.guard == nullptr) return true;
  double value = 1.0;
  demand_success("guard", run, given.guard(run.t, run.x.data(), run.xdot.data(), &value, given.user));
  return value > 0.0;
}

// The first condition that holds at the start of the mode; -1: none. Others hold later if they rise clearly above their
// present value: so their sign is certain here, and a condition that is zero here holds once it rises.
int find_condition(HybridSystem& hybrid) {
  const HybridRun& run = hybrid.run;
  for (const int k : hybrid.mode().watched) {
    const sfdae_transition& given = hybrid.transitions[index(k)].given;
    if (given.kind != SFDAE_TRANSITION_CONDITION) continue;
    const double value = function_at(run, given, run.t, run.x.data(), run.xdot.data());
    double& margin = hybrid.transitions[index(k)].margin;
    if (!(value > margin)) {
      if (value > 0.0) margin += value;
      continue;
    }
    if (is_open(run, given)) return k;
  }
  return -1;
}

// The first transition due at the point reached, -1: none; candidates are events that fired and transitions at this
// time.
int find_due(const HybridSystem& hybrid, bool is_event) {
  const HybridRun& run = hybrid.run;
  const HybridMode& mode = hybrid.mode();
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
    if (hybrid.transitions[index(k)].given.time == run.t && run.t != run.visit.entered) due.push_back(k);
  std::sort(due.begin(), due.end());
  for (const int k : due)
    if (is_open(run, hybrid.transitions[index(k)].given)) return k;
  return -1;
}

double next_target(const HybridSystem& hybrid, double tout) {
  const HybridRun& run = hybrid.run;
  for (const int k : hybrid.mode().timed) {
    const double time = hybrid.transitions[index(k)].given.time;
    if ((time - run.t) * run.direction() > 0.0 && (tout - time) * run.direction() > 0.0) tout = time;
  }
  return tout;
}

// Takes transitions whose conditions hold at the start of modes. Returns true if there was any.
bool leave_at_once(HybridSystem& hybrid, bool only_once) {
  bool has_left = false;
  while (hybrid.run.visit.is_fresh && !(has_left && only_once)) {
    const int number = find_condition(hybrid);
    hybrid.run.visit.is_fresh = false;
    if (number < 0) break;
    go_over(hybrid, number, true);
    has_left = true;
  }
  return has_left;
}

HybridRun run_from(const HybridSystem& hybrid, const PointOfInterest& point) {
  const std::size_t n = index(hybrid.n());
  HybridRun run;
  run.start = run.visit.entered = run.t = point.t;
  run.toward = point.toward;
  run.x.assign(point.x, point.x + n);
  run.x.resize(index(hybrid.width()), 0.0);
  run.xdot.assign(run.x.size(), 0.0);
  if (point.xdot != nullptr) std::copy_n(point.xdot, n, run.xdot.begin());
  if (hybrid.sensitivities) {
    run.moving.shifts.assign(hybrid.sensitivities->names.size(), 0.0);
    run.moving.moved = directions_at_start(hybrid);
  }
  return run;
}

CallResult start_run(HybridSystem& hybrid, int mode, const PointOfInterest& point) {
  update_switches(hybrid);
  ask_for_sensitivities(hybrid);
  set_transition_events(hybrid);
  hybrid.run = run_from(hybrid, point);
  hybrid.kept = {};
  for (HybridMode& each : hybrid.modes) each.left = {};
  for (HybridTransition& each : hybrid.transitions) each.passages.clear();
  prepare_sliding(hybrid, mode);
  enter(hybrid, mode);
  leave_at_once(hybrid, false);
  return std::exchange(hybrid.run.warning, {});
}

CallResult advance_modes(HybridSystem& hybrid, double tout, bool stops_at_transition, bool wants_slopes) {
  HybridRun& run = hybrid.run;
  run.warning = {};
  update_switches(hybrid);
  for (;;) {
    if (leave_at_once(hybrid, stops_at_transition) && stops_at_transition) return {SFDAE_EVENT, ""};
    if (hybrid.stop_is_requested.exchange(false)) return {SFDAE_STOPPED, "stopped by sfdae_request_stop_hybrid."};
    const double target = next_target(hybrid, tout);
    double* xdot = wants_slopes || hybrid.mode().needs_slopes || hybrid.sensitivities ? run.xdot.data() : nullptr;
    CallResult result = hybrid.call(
        run.mode, [&](Solver& solver) { return solver.advance(target, false, run.t, run.x.data(), xdot); });
    const bool is_event = result.status == SFDAE_EVENT;
    if (!is_event) keep_warning(run, std::move(result));
    const int number = find_due(hybrid, is_event);
    if (number >= 0) {
      go_over(hybrid, number, false);
      if (stops_at_transition) return {SFDAE_EVENT, ""};
    } else if (!is_event && run.t == tout) {
      return std::exchange(run.warning, {});
    }
  }
}

}  // namespace

void VisitCounts::add(const IntegrationCounts& counts) {
  steps += counts.steps;
  error_failures += counts.error_failures;
  other_failures += counts.other_failures;
  reductions += counts.reductions;
  factorizations += counts.factorizations;
  if (counts.smallest_kept > 0.0)
    smallest_kept = smallest_kept > 0.0 ? std::min(smallest_kept, counts.smallest_kept) : counts.smallest_kept;
  consistency = std::max(consistency, counts.inconsistency);
  rounding = std::max(rounding, counts.rounding);
}

double HybridRun::toward_from() const {
  return (toward - t) * direction() > 0.0 ? toward : time_beside(t, direction());
}

void set_events_of(HybridSystem& hybrid, int k) {
  HybridMode& mode = hybrid.modes[index(k)];
  std::vector<int> directions;
  for (const int number : mode.watched) {
    const sfdae_transition& given = hybrid.transitions[index(number)].given;
    directions.push_back(given.kind == SFDAE_TRANSITION_CONDITION ? 1 : given.direction);
  }
  for (const int number : mode.watched)
    if (hybrid.transitions[index(number)].surface != nullptr) directions.push_back(1);
  std::unique_ptr<Events> events;
  if (!directions.empty()) {
    events = std::make_unique<Events>(evaluate_watched, &mode, std::move(directions));
    for (std::size_t i = 0; i < mode.watched.size(); ++i)
      if (hybrid.transitions[index(mode.watched[i])].given.kind == SFDAE_TRANSITION_CONDITION)
        events->search.set_clear_at_start(i);
    // With sensitivities no function may depend on x'.
    events->tries_without_slopes = hybrid.sensitivities.has_value();
  }
  hybrid.call(k, [&events](Solver& solver) { solver.set_events(std::move(events)); });
}

void set_transition_events(HybridSystem& hybrid) {
  if (!hybrid.events_are_set) {
    list_transitions(hybrid);
    for (int k = 0; k < static_cast<int>(hybrid.modes.size()); ++k) set_events_of(hybrid, k);
  }
  hybrid.events_are_set = true;
  // The events may have been set with or without sensitivities.
  for (HybridMode& mode : hybrid.modes)
    if (mode.solver->events) mode.solver->events->tries_without_slopes = hybrid.sensitivities.has_value();
}

namespace {

// Turns failures into results. Other exceptions end the run: continuing would miss events of the last step.
template <class Body>
CallResult result_in(HybridRun& run, Body body) {
  try {
    return body();
  } catch (const Failure& failure) {
    return {failure.status(), failure.what()};
  } catch (...) {
    run.mode = -1;
    throw;
  }
}

}  // namespace

CallResult HybridSystem::start(int mode, const PointOfInterest& point) {
  return result_in(run, [&] { return start_run(*this, mode, point); });
}

CallResult HybridSystem::advance(double tout, bool stops_at_transition, bool wants_slopes) {
  return result_in(run, [&] { return advance_modes(*this, tout, stops_at_transition, wants_slopes); });
}

}  // namespace sfdae::core
