// SPDX-License-Identifier: BSD-3-Clause
#include "hybrid/accumulation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"
#include "linalg/random.h"

namespace sfdae::core {

namespace {

constexpr std::size_t remembered = 7;  // passages of a transition, six time intervals
constexpr double equal_factors = 0.1;  // tolerance for the ratios of the intervals, relative to one minus the ratio
// Accumulation: remaining time relative to the time since the start, or remaining change of the transition function, in
// tolerances.
constexpr double time_left = 1e-6, tolerances_left = 1e3;
constexpr double short_visit = 10.0;  // tolerances by which x moves
// Negligible relative changes of t and x': larger than those of EventValues::rounding, so that a function that is
// larger than its resulting change has a sign in an event search.
constexpr double some_roundings = 256.0 * std::numeric_limits<double>::epsilon();

// x moved randomly within its tolerances.
std::vector<double> moved(const std::vector<double>& x, const Tolerances& tolerances, std::minstd_rand& random) {
  std::vector<double> result(x);
  for (std::size_t i = 0; i < tolerances.rtol.size(); ++i)
    result[i] += symmetric_random(random) * (tolerances.rtol[i] * std::fabs(x[i]) + tolerances.atol[i]);
  return result;
}

// Time until the first component has moved by its tolerance.
double time_to_move(const HybridRun& run, const Tolerances& tolerances) {
  double time = std::fabs(run.toward_from() - run.t);
  for (std::size_t i = 0; i < tolerances.rtol.size(); ++i) {
    const double tolerance = tolerances.rtol[i] * std::fabs(run.x[i]) + tolerances.atol[i];
    if (std::fabs(run.xdot[i]) * time > tolerance) time = tolerance / std::fabs(run.xdot[i]);
  }
  return time;
}

// For times whose intervals shrink by a constant factor q: the time from the last one to their limit, the last interval
// times q / (1 - q).
std::optional<double> time_to_limit(const std::vector<double>& times) {
  if (times.size() < remembered) return std::nullopt;
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (std::size_t k = 2; k < times.size(); ++k) {
    if (times[k - 1] == times[k - 2]) return std::nullopt;
    const double factor = (times[k] - times[k - 1]) / (times[k - 1] - times[k - 2]);
    least = std::min(least, factor);
    most = std::max(most, factor);
  }
  if (!(least > 0.0 && most < 1.0 && most - least <= equal_factors * (1.0 - most))) return std::nullopt;
  const double first = times[1] - times[0], last = times.back() - times[times.size() - 2];
  const double q = std::pow(last / first, 1.0 / static_cast<double>(remembered - 2));
  return last * q / (1.0 - q);
}

// True if the remaining time is negligible, or the function hardly changes within a quarter of the last interval.
bool is_at_rest(const HybridSystem& hybrid, const HybridTransition& transition, double rest) {
  const HybridRun& run = hybrid.run;
  const sfdae_transition& given = transition.given;
  if (std::fabs(rest) <= time_left * std::fabs(run.t - run.start)) return true;
  if (given.function == nullptr) return false;
  const std::vector<double>& times = transition.passages;
  const double part = 0.25 * (times.back() - times[times.size() - 2]);
  std::vector<double> x(run.x);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += part * run.xdot[i];
  const double here = function_at(run, given, run.t, run.x.data(), run.xdot.data());
  const double there = function_at(run, given, run.t + part, x.data(), run.xdot.data());
  return std::fabs(there - here) <= tolerances_left * margin_of(hybrid, given);
}

const char* name_of_function(const sfdae_transition& given) {
  for (int k = 0; k < 4; ++k)
    if (given.function == Switch::condition(k)) return "the surface of a switch, which is not defined there,";
  return "function";
}

}  // namespace

void demand_success(const char* what, const HybridRun& run, int returned) {
  if (returned == 0) return;
  throw Failure(returned < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED,
                format("%s returned %d at t = %.10g.", what, returned, run.t));
}

double function_at(const HybridRun& run, const sfdae_transition& given, double t, const double* x,
                   const double* xdot) {
  double value = 0.0;
  demand_success(name_of_function(given), run, given.function(t, x, xdot, &value, given.user));
  return value;
}

double margin_of(const HybridSystem& hybrid, const sfdae_transition& given) {
  const HybridRun& run = hybrid.run;
  const Tolerances& tolerances = hybrid.modes[index(given.from)].solver->options.model.tolerances;
  const double beside = some_roundings * std::max(std::fabs(run.t), std::fabs(run.toward)) * run.direction();
  std::minstd_rand random(11);
  const double here = function_at(run, given, run.t, run.x.data(), run.xdot.data());
  // Positive: the sign of a constant function must be certain, too.
  double margin = std::numeric_limits<double>::min();
  const auto look_at = [&](double t, const std::vector<double>& x, const std::vector<double>& xdot) {
    const double there = function_at(run, given, t, x.data(), xdot.data());
    if (std::isfinite(there)) margin = std::max(margin, std::fabs(there - here));
  };
  look_at(run.t + beside, run.x, run.xdot);
  for (int k = 0; k < 4; ++k) {
    // Both sides: a function may have a kink here.
    std::vector<double> x = moved(run.x, tolerances, random);
    look_at(run.t, x, run.xdot);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = 2.0 * run.x[i] - x[i];
    look_at(run.t, x, run.xdot);
  }
  std::vector<double> xdot(run.xdot);
  for (double& value : xdot) value *= 1.0 + some_roundings * symmetric_random(random);
  look_at(run.t, run.x, xdot);
  return margin;
}

double time_of_short_visit(const HybridRun& run, const Tolerances& tolerances) {
  return short_visit * time_to_move(run, tolerances);
}

void count_short_visit(HybridRun& run) {
  if (std::fabs(run.t - run.visit.entered) > run.visit.short_time) {
    run.short_visits.count = 0;
  } else if (run.short_visits.count++ == 0) {
    run.short_visits.first = run.visit.entered;
  }
}

void note_passage(HybridTransition& transition, double t) {
  std::vector<double>& times = transition.passages;
  if (times.size() == remembered) times.erase(times.begin());
  times.push_back(t);
}

void check_accumulation(HybridSystem& hybrid, const HybridTransition& last) {
  HybridRun& run = hybrid.run;
  const std::string from = hybrid.name_of(last.given.from), to = hybrid.name_of(last.given.to);
  if (const auto rest = time_to_limit(last.passages); rest && is_at_rest(hybrid, last, *rest)) {
    run.accumulation = run.t + *rest;
    throw Failure(SFDAE_ZENO,
                  format("transitions accumulate at t = %.10g: the times between those from %s to %s shrink by a "
                         "constant factor. Start there in the mode that holds after that.",
                         *run.accumulation, from.c_str(), to.c_str()));
  }
  const long many = 30 + 2 * static_cast<long>(hybrid.modes.size());
  const ShortVisits& visits = run.short_visits;
  if (visits.count < many) return;
  run.accumulation = visits.first;
  throw Failure(
      SFDAE_ZENO,
      format(
          "%ld transitions from t = %.10g to %.10g, the last one from %s to %s: each leads back at once. Where modes "
          "lead toward a surface from both sides, sfdae_add_switch adds the mode of the motion along it.",
          visits.count, visits.first, run.t, from.c_str(), to.c_str()));
}

}  // namespace sfdae::core
