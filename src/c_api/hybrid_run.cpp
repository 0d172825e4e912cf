// A run across modes: each is entered with the values that its equations make of those before, and left where a
// transition is due.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "c_api/hybrid.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "linalg/random.h"

namespace sfdae::core {

namespace {

constexpr std::size_t remembered = 7;  // passages of a transition, six times between them
constexpr double equal_factors = 0.1;  // of one minus the factor by which these times shrink
// When transitions accumulate: the time that is left, of that since the start, or what the function of the transition still
// does, in tolerances.
constexpr double time_left = 1e-6, tolerances_left = 1e3;
constexpr double short_visit = 10.0;  // tolerances that x moves by

CallResult of_mode(const sfdae_hybrid& hybrid, int mode, int status) {
  const char* said = sfdae_message(hybrid.modes[index(mode)].solver);
  return {status, *said != '\0' ? hybrid.name_of(mode) + ": " + said : std::string()};
}

CallResult of_callback(const char* what, const HybridRun& run, int returned) {
  return {returned < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED,
          format("%s returned %d at t = %.10g.", what, returned, run.t)};
}

void keep_warning(HybridRun& run, CallResult result) {
  if (result.status > 0 && run.warning.status == SFDAE_OK) run.warning = std::move(result);
}

// The transitions of a mode that are events of its solver, in their order.
int evaluate_watched(double t, const double* x, const double* xdot, double* g, void* user) {
  const HybridMode& mode = *static_cast<const HybridMode*>(user);
  for (std::size_t i = 0; i < mode.watched.size(); ++i) {
    const sfdae_transition& given = (*mode.transitions)[index(mode.watched[i])].given;
    const int returned = given.function(t, x, xdot, g + i, given.user);
    if (returned != 0) return returned;
    if (given.kind == SFDAE_TRANSITION_CONDITION) g[i] -= (*mode.transitions)[index(mode.watched[i])].margin;
  }
  return 0;
}

// Toward the end of the run, or beside t once that is passed.
double toward_from(const HybridRun& run) {
  return (run.toward - run.t) * run.direction() > 0.0 ? run.toward : time_beside(run.t, run.direction());
}

// Calls a solver, and once more after a new analysis if the one that it had does not hold here.
template <class Call>
CallResult with_analysis(sfdae_hybrid& hybrid, int to, const double* x, Call call) {
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

// x moved by its tolerances, or part of them, in directions at random.
std::vector<double> moved(const std::vector<double>& x, const Tolerances& tolerances, std::minstd_rand& random) {
  std::vector<double> result(x);
  for (std::size_t i = 0; i < x.size(); ++i)
    result[i] += symmetric_random(random) * (tolerances.rtol[i] * std::fabs(x[i]) + tolerances.atol[i]);
  return result;
}

// How much the function of a transition changes when x moves by its tolerances, or t by some roundings.
CallResult find_margin(const sfdae_hybrid& hybrid, const sfdae_transition& given, double& margin) {
  const HybridRun& run = hybrid.run;
  const Tolerances& tolerances = hybrid.modes[index(given.from)].solver->options.model.tolerances;
  const double beside = 256.0 * std::numeric_limits<double>::epsilon() *
                        std::max(std::fabs(run.t), std::fabs(run.toward)) * run.direction();
  std::minstd_rand random(11);
  double here = 0.0;
  int returned = given.function(run.t, run.x.data(), run.xdot.data(), &here, given.user);
  margin = 0.0;
  for (int k = 0; k < 5 && returned == 0; ++k) {
    double there = 0.0;
    const std::vector<double> x = k == 0 ? run.x : moved(run.x, tolerances, random);
    returned = given.function(k == 0 ? run.t + beside : run.t, x.data(), run.xdot.data(), &there, given.user);
    if (std::isfinite(there)) margin = std::max(margin, std::fabs(there - here));
  }
  return returned != 0 ? of_callback("function", run, returned) : CallResult{};
}

void record_in(sfdae_hybrid& hybrid, int mode) {
  for (HybridMode& other : hybrid.modes) {
    if (&other == &hybrid.modes[index(mode)] || other.solver->solution.expired()) continue;
    other.solver->solution.reset();
    if (other.solver->integration) other.solver->integration->record({});
  }
  if (!hybrid.solution.expired()) hybrid.modes[index(mode)].solver->solution = hybrid.solution;
}

// The time in which the first component moves by its tolerance.
double time_to_move(const HybridRun& run, const Tolerances& tolerances) {
  double time = std::fabs(toward_from(run) - run.t);
  for (std::size_t i = 0; i < run.x.size(); ++i) {
    const double tolerance = tolerances.rtol[i] * std::fabs(run.x[i]) + tolerances.atol[i];
    if (std::fabs(run.xdot[i]) * time > tolerance) time = tolerance / std::fabs(run.xdot[i]);
  }
  return time;
}

// From run.t, run.x.
CallResult enter(sfdae_hybrid& hybrid, int to) {
  HybridRun& run = hybrid.run;
  run.mode = -1;
  record_in(hybrid, to);
  CallResult result;
  for (const int k : hybrid.modes[index(to)].watched) {
    HybridTransition& transition = hybrid.transitions[index(k)];
    result = find_margin(hybrid, transition.given, transition.margin);
    if (result.status < 0) return result;
  }
  result = with_analysis(hybrid, to, run.x.data(), [&](sfdae_solver* solver) {
    return sfdae_start(solver, run.t, toward_from(run), run.x.data(), run.xdot.data());
  });
  if (result.status < 0) return result;
  keep_warning(run, std::move(result));
  run.mode = to;
  run.entered = run.t;
  run.is_fresh = true;
  run.short_time = short_visit * time_to_move(run, hybrid.modes[index(to)].solver->options.model.tolerances);
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

// Times whose distances shrink by one factor q: the time from the last one to their limit, the last distance times
// q / (1 - q).
std::optional<double> time_to_limit(const std::vector<double>& times) {
  if (times.size() < remembered) return std::nullopt;
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (std::size_t k = 2; k < times.size(); ++k) {
    const double factor = (times[k] - times[k - 1]) / (times[k - 1] - times[k - 2]);
    least = std::min(least, factor);
    most = std::max(most, factor);
  }
  if (!(least > 0.0 && most < 1.0 && most - least <= equal_factors * (1.0 - most))) return std::nullopt;
  const double first = times[1] - times[0], last = times.back() - times[times.size() - 2];
  const double q = std::pow(last / first, 1.0 / static_cast<double>(remembered - 2));
  return last * q / (1.0 - q);
}

// Whether the function hardly moves any more until the next passage, half of the way to the limit, say.
CallResult is_at_rest(const sfdae_hybrid& hybrid, const HybridTransition& transition, double rest, bool& at_rest) {
  const HybridRun& run = hybrid.run;
  const sfdae_transition& given = transition.given;
  at_rest = std::fabs(rest) <= time_left * std::fabs(run.t - run.start);
  if (at_rest || given.function == nullptr) return {};
  const std::vector<double>& times = transition.passages;
  const double part = 0.25 * (times.back() - times[times.size() - 2]);
  std::vector<double> x(run.x);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += part * run.xdot[i];
  double here = 0.0, there = 0.0, margin = 0.0;
  int returned = given.function(run.t, run.x.data(), run.xdot.data(), &here, given.user);
  if (returned == 0) returned = given.function(run.t + part, x.data(), run.xdot.data(), &there, given.user);
  if (returned != 0) return of_callback("function", run, returned);
  CallResult result = find_margin(hybrid, given, margin);
  at_rest = std::fabs(there - here) <= tolerances_left * margin;
  return result;
}

CallResult check_accumulation(sfdae_hybrid& hybrid, const HybridTransition& last) {
  HybridRun& run = hybrid.run;
  const std::string from = hybrid.name_of(last.given.from), to = hybrid.name_of(last.given.to);
  if (const auto rest = time_to_limit(last.passages)) {
    bool at_rest = false;
    CallResult result = is_at_rest(hybrid, last, *rest, at_rest);
    if (result.status < 0) return result;
    if (at_rest) {
      run.accumulation = run.t + *rest;
      return {SFDAE_ZENO,
              format("transitions accumulate at t = %.10g: the times between those from %s to %s shrink by a "
                     "constant factor. Start there in the mode that holds after that.",
                     *run.accumulation, from.c_str(), to.c_str())};
    }
  }
  const long many = 30 + 2 * static_cast<long>(hybrid.modes.size());
  if (run.short_visits < many) return {};
  run.accumulation = run.first_short;
  return {
      SFDAE_ZENO,
      format(
          "%ld transitions from t = %.10g to %.10g, the last one from %s to %s: each leads back at once. Where modes "
          "lead toward a surface from both sides, the motion along it needs a mode of its own.",
          run.short_visits, run.first_short, run.t, from.c_str(), to.c_str())};
}

// Visits that end before x has moved by more than a few tolerances.
void count_short_visit(HybridRun& run) {
  if (std::fabs(run.t - run.entered) > run.short_time) {
    run.short_visits = 0;
  } else if (run.short_visits++ == 0) {
    run.first_short = run.entered;
  }
}

CallResult pass(sfdae_hybrid& hybrid, int number) {
  HybridRun& run = hybrid.run;
  HybridTransition& transition = hybrid.transitions[index(number)];
  const sfdae_transition& given = transition.given;
  count_short_visit(run);
  leave(hybrid);
  CallResult result = find_values_after(hybrid, given);
  if (result.status >= 0) {
    keep_warning(run, std::move(result));
    run.x = run.after;
    result = enter(hybrid, given.to);
  }
  if (result.status < 0) {
    run.mode = -1;
    run.x = run.before;
    return result;
  }
  run.after = run.x;
  std::vector<double> change(run.x);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= run.before[i];
  const auto [impulse, where] = largest_of(run.impulse);
  const auto [largest, changed] = largest_of(change);
  run.passages.push_back(
      {sizeof(sfdae_passage), run.t, number, given.from, given.to, impulse, where, largest, changed});
  if (transition.passages.size() == remembered) transition.passages.erase(transition.passages.begin());
  transition.passages.push_back(run.t);
  return check_accumulation(hybrid, transition);
}

// Whether the guard, if there is one, is > 0 at the point reached.
CallResult ask_guard(const HybridRun& run, const sfdae_transition& given, bool& is_open) {
  double value = 1.0;
  const int returned =
      given.guard != nullptr ? given.guard(run.t, run.x.data(), run.xdot.data(), &value, given.user) : 0;
  is_open = value > 0.0;
  return returned != 0 ? of_callback("guard", run, returned) : CallResult{};
}

// The first condition that holds where the mode begins; -1: none.
CallResult find_condition(const sfdae_hybrid& hybrid, int& number) {
  const HybridRun& run = hybrid.run;
  const HybridMode& mode = hybrid.mode();
  number = -1;
  for (const int k : mode.watched) {
    const sfdae_transition& given = hybrid.transitions[index(k)].given;
    if (given.kind != SFDAE_TRANSITION_CONDITION) continue;
    double value = 0.0;
    const int returned = given.function(run.t, run.x.data(), run.xdot.data(), &value, given.user);
    if (returned != 0) return of_callback("function", run, returned);
    bool is_open = false;
    if (value > hybrid.transitions[index(k)].margin) {
      CallResult asked = ask_guard(run, given, is_open);
      if (asked.status != SFDAE_OK) return asked;
    }
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
    for (std::size_t i = 0; i < mode.watched.size(); ++i)
      if (fired[i] != 0) due.push_back(mode.watched[i]);
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
    result = pass(hybrid, number);
    has_left = true;
    if (result.status < 0 || only_once) return result;
  }
  return {};
}

}  // namespace

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

CallResult set_transition_events(sfdae_hybrid& hybrid) {
  for (std::size_t k = 0; k < hybrid.modes.size() && !hybrid.events_are_set; ++k) {
    HybridMode& mode = hybrid.modes[k];
    std::vector<int> directions;
    for (const int number : mode.watched) {
      const sfdae_transition& given = hybrid.transitions[index(number)].given;
      directions.push_back(given.kind == SFDAE_TRANSITION_CONDITION ? 1 : given.direction);
    }
    const int status = sfdae_set_events(mode.solver, static_cast<int>(directions.size()), evaluate_watched,
                                        directions.data(), &mode);
    if (status < 0) return of_mode(hybrid, static_cast<int>(k), status);
  }
  hybrid.events_are_set = true;
  return {};
}

CallResult start_run(sfdae_hybrid& hybrid, int mode, const PointOfInterest& point) {
  CallResult result = set_transition_events(hybrid);
  if (result.status < 0) return result;
  const std::size_t n = index(hybrid.n());
  HybridRun run;
  run.start = run.entered = run.t = point.t;
  run.toward = point.toward;
  run.x.assign(point.x, point.x + n);
  run.xdot.assign(n, 0.0);
  if (point.xdot != nullptr) std::copy_n(point.xdot, n, run.xdot.begin());
  hybrid.run = std::move(run);
  for (HybridMode& each : hybrid.modes) each.left = {};
  for (HybridTransition& each : hybrid.transitions) each.passages.clear();
  result = enter(hybrid, mode);
  bool has_left = false;
  if (result.status >= 0) result = leave_at_once(hybrid, false, has_left);
  hybrid.running.store(nullptr);
  return result.status < 0 ? result : std::exchange(hybrid.run.warning, {});
}

CallResult advance_run(sfdae_hybrid& hybrid, double tout, bool stops_at_transition, bool wants_slopes) {
  HybridRun& run = hybrid.run;
  run.warning = {};
  for (;;) {
    bool has_left = false;
    CallResult result = leave_at_once(hybrid, stops_at_transition, has_left);
    if (result.status < 0) return result;
    if (has_left && stops_at_transition) return {SFDAE_EVENT, ""};
    if (hybrid.stop_is_requested.exchange(false)) return {SFDAE_STOPPED, "stopped by sfdae_request_stop_hybrid."};
    const HybridMode& mode = hybrid.mode();
    const double target = next_target(hybrid, tout);
    double* xdot = wants_slopes || mode.has_guards ? run.xdot.data() : nullptr;
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
      result = pass(hybrid, number);
      if (result.status < 0) return result;
      if (stops_at_transition) return {SFDAE_EVENT, ""};
    } else if (status != SFDAE_EVENT && run.t == tout) {
      return std::exchange(run.warning, {});
    }
  }
}

}  // namespace sfdae::core
