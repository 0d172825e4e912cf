// Where a hybrid system cannot go on: transitions that accumulate, modes that lead to each other at once; and how
// well the functions of transitions are known.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "c_api/hybrid.h"
#include "linalg/index.h"
#include "linalg/random.h"

namespace sfdae::core {

namespace {

constexpr std::size_t remembered = 7;  // passages of a transition, six times between them
constexpr double equal_factors = 0.1;  // of one minus the factor by which these times shrink
// When transitions accumulate: the time that is left, of that since the start, or what the function of the transition
// still does, in tolerances.
constexpr double time_left = 1e-6, tolerances_left = 1e3;
constexpr double short_visit = 10.0;  // tolerances that x moves by
// Relative changes of t and x' that say nothing: more than those of EventValues::rounding, so that a function that is
// larger than what it changes by has a sign for a search of events.
constexpr double some_roundings = 256.0 * std::numeric_limits<double>::epsilon();

// x moved by its tolerances, or part of them, in directions at random.
std::vector<double> moved(const std::vector<double>& x, const Tolerances& tolerances, std::minstd_rand& random) {
  std::vector<double> result(x);
  for (std::size_t i = 0; i < tolerances.rtol.size(); ++i)
    result[i] += symmetric_random(random) * (tolerances.rtol[i] * std::fabs(x[i]) + tolerances.atol[i]);
  return result;
}

// The time in which the first component moves by its tolerance.
double time_to_move(const HybridRun& run, const Tolerances& tolerances) {
  double time = std::fabs(toward_from(run) - run.t);
  for (std::size_t i = 0; i < tolerances.rtol.size(); ++i) {
    const double tolerance = tolerances.rtol[i] * std::fabs(run.x[i]) + tolerances.atol[i];
    if (std::fabs(run.xdot[i]) * time > tolerance) time = tolerance / std::fabs(run.xdot[i]);
  }
  return time;
}

// Times whose distances shrink by one factor q: the time from the last one to their limit, the last distance times
// q / (1 - q).
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
  if (returned != 0) return of_callback(name_of_function(given), run, returned);
  CallResult result = find_margin(hybrid, given, margin);
  at_rest = std::fabs(there - here) <= tolerances_left * margin;
  return result;
}

}  // namespace

CallResult of_callback(const char* what, const HybridRun& run, int returned) {
  return {returned < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED,
          format("%s returned %d at t = %.10g.", what, returned, run.t)};
}

const char* name_of_function(const sfdae_transition& given) {
  for (int k = 0; k < 4; ++k)
    if (given.function == Switch::condition(k)) return "the surface of a switch, which is not defined there,";
  return "function";
}

double toward_from(const HybridRun& run) {
  return (run.toward - run.t) * run.direction() > 0.0 ? run.toward : time_beside(run.t, run.direction());
}

CallResult find_margin(const sfdae_hybrid& hybrid, const sfdae_transition& given, double& margin) {
  const HybridRun& run = hybrid.run;
  const Tolerances& tolerances = hybrid.modes[index(given.from)].solver->options.model.tolerances;
  const double beside = some_roundings * std::max(std::fabs(run.t), std::fabs(run.toward)) * run.direction();
  std::minstd_rand random(11);
  double here = 0.0;
  int returned = given.function(run.t, run.x.data(), run.xdot.data(), &here, given.user);
  // Not 0: the sign that a function has where it is constant has to be known, too.
  margin = std::numeric_limits<double>::min();
  const auto look_at = [&](double t, const std::vector<double>& x, const std::vector<double>& xdot) {
    double there = 0.0;
    if (returned == 0) returned = given.function(t, x.data(), xdot.data(), &there, given.user);
    if (returned == 0 && std::isfinite(there)) margin = std::max(margin, std::fabs(there - here));
  };
  look_at(run.t + beside, run.x, run.xdot);
  for (int k = 0; k < 4; ++k) {
    // To both sides: a function may have a kink here.
    std::vector<double> x = moved(run.x, tolerances, random);
    look_at(run.t, x, run.xdot);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = 2.0 * run.x[i] - x[i];
    look_at(run.t, x, run.xdot);
  }
  std::vector<double> xdot(run.xdot);
  for (double& value : xdot) value *= 1.0 + some_roundings * symmetric_random(random);
  look_at(run.t, run.x, xdot);
  return returned != 0 ? of_callback(name_of_function(given), run, returned) : CallResult{};
}

double time_of_short_visit(const HybridRun& run, const Tolerances& tolerances) {
  return short_visit * time_to_move(run, tolerances);
}

void count_short_visit(HybridRun& run) {
  if (std::fabs(run.t - run.entered) > run.short_time) {
    run.short_visits = 0;
  } else if (run.short_visits++ == 0) {
    run.first_short = run.entered;
  }
}

void note_passage(HybridTransition& transition, double t) {
  std::vector<double>& times = transition.passages;
  if (times.size() == remembered) times.erase(times.begin());
  times.push_back(t);
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
          "lead toward a surface from both sides, sfdae_add_switch adds the mode of the motion along it.",
          run.short_visits, run.first_short, run.t, from.c_str(), to.c_str())};
}

}  // namespace sfdae::core
