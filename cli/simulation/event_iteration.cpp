// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/event_iteration.h"

#include <algorithm>
#include <cmath>

#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Discrete variables may count a few steps at an event, but not endlessly.
constexpr int max_iterations = 500;
// Interdependent switches and equations: first, all switches change at once; then one by one, which finds the mode of
// complementarity problems with P-matrices (Murty's least-index method).
constexpr int max_at_once = 20, max_settling = 400;
// Search for states that can be kept, in units of nominal values.
constexpr int reweightings = 15;
constexpr double same_value = 1e-12;  // for discrete values, relative to the largest one at the event
constexpr double free_weight = 1e6, smallest_weight = 1e-12, unchanged = 1e-5;

}  // namespace

EventIteration::EventIteration(const System& system, Modes& modes, LibraryCalls& calls, Switches& switches,
                               Discrete& discrete, double interval, std::vector<std::string>& warnings)
    : system_(system),
      modes_(modes),
      calls_(calls),
      switches_(switches),
      discrete_(discrete),
      interval_(interval),
      warnings_(warnings),
      is_reported_(system.reactions.size(), 0) {}

std::vector<int> EventIteration::with_states(std::vector<int> fixed, const std::vector<char>& of_variable) const {
  fixed.resize(modes_.unknowns().size(), 0);
  for (std::size_t j = 0; j < fixed.size(); ++j) {
    const int v = modes_.unknowns()[j];
    if (v < 0 || of_variable[at(v)] != 0) fixed[j] = 1;
  }
  return fixed;
}

bool EventIteration::attempt(Mode& mode, sfdae::Point& point, const std::vector<int>& fixed) {
  sfdae::Point trial = point;
  if (calls_.attempt(mode, [&] { return mode.make_consistent(trial, fixed); }) < 0) return false;
  point = std::move(trial);
  return true;
}

// States for which new constraints hold jump by impulses of the new equations: momentum and charge are kept.
void EventIteration::solve(Values& values, sfdae::Point& point) {
  const std::shared_ptr<Mode> mode = modes_.at_values(values);
  const std::string event = "event at t = " + to_text(values.t);
  const auto make_consistent = [&] {
    return calls_.run(*mode, Phase::integration, event, [&] { return mode->make_consistent(point, {}); });
  };
  const sfdae::Point before = point;
  if (make_consistent() == SFDAE_VALUES_CHANGED) {
    point = before;
    const auto jump = [&] {
      point.x = mode->solver.jump(before.t, before.t + interval_, before.x).after;
      return SFDAE_OK;
    };
    const int status = calls_.attempt(*mode, jump);
    if (status < 0)
      throw Failure(Outcome::not_finished, status,
                    event +
                        ": states have to jump, since new constraints hold, and impulses do not determine by how "
                        "much: " +
                        calls_.message());
    make_consistent();
  }
  solved_key_ = modes_.equations_key(values);
  has_solved_ = true;
  modes_.to_values(point, values);
}

// After reinit: keeps the other states if the constraints allow it.
void EventIteration::solve_keeping_states(Values& values, sfdae::Point& point, const std::vector<int>& fixed) {
  const std::shared_ptr<Mode> mode = modes_.at_values(values);
  const bool is_solved = attempt(*mode, point, with_states(fixed, system_.is_state)) ||
                         attempt(*mode, point, with_states(fixed, system_.is_continuous_at_impulses)) ||
                         attempt(*mode, point, states_to_keep(*mode, point, fixed));
  if (!is_solved)
    calls_.run(*mode, Phase::integration, "reinit at t = " + to_text(values.t),
               [&] { return mode->make_consistent(point, fixed); });
  solved_key_ = modes_.equations_key(values);
  has_solved_ = true;
  modes_.to_values(point, values);
}

// Finds states that can be kept after reinit has set others: weights that follow the changes (iteratively reweighted
// least squares) drive most changes to zero.
std::vector<int> EventIteration::states_to_keep(Mode& mode, const sfdae::Point& point,
                                                const std::vector<int>& fixed) {
  const std::size_t n = point.x.size();
  const auto nominal = [&](std::size_t j) {
    const int v = modes_.unknowns()[j];
    return v >= 0 ? system_.sizes.nominal[at(v)] : 1.0;
  };
  std::vector<double> weights(n);
  std::vector<int> result = fixed;
  const auto is_state = [&](std::size_t j) {
    return modes_.unknowns()[j] >= 0 && system_.is_state[at(modes_.unknowns()[j])] != 0;
  };
  for (std::size_t j = 0; j < n; ++j) weights[j] = nominal(j) * (is_state(j) ? 1.0 : free_weight);
  for (int k = 0; k < reweightings; ++k) {
    sfdae::Point moved = point;
    mode.options.initial_weights = weights;
    const int status = calls_.attempt(mode, [&] { return mode.make_consistent(moved, fixed); });
    mode.options.initial_weights.clear();
    if (status < 0) return fixed;
    for (std::size_t j = 0; j < n; ++j) {
      const double change = std::fabs(moved.x[j] - point.x[j]) / nominal(j);
      if (is_state(j)) weights[j] = nominal(j) * std::sqrt(change + smallest_weight);
      if (is_state(j) && k + 1 == reweightings && change < unchanged) result[j] = 1;
    }
  }
  return result;
}

std::string EventIteration::changing(const Values& before, const Values& values) const {
  std::string text;
  for (std::size_t s = 0; s < values.switches.size(); ++s)
    if (before.switches[s] != values.switches[s])
      text += (text.empty() ? "" : ", ") + system_.switches[s].text + " (" +
              place(system_.model, system_.switches[s].at) + ")";
  for (std::size_t v = 0; v < system_.model.variables.size(); ++v)
    if (!are_same(before.variable[v], values.variable[v]) &&
        !system_.formulas.depends(system_.values[v], on_continuous))
      text += (text.empty() ? "" : ", ") + system_.model.variables[v].name;
  return text;
}

// Reevaluates discrete variables, since values from when clauses may depend on unknowns solved after them. Returns
// whether they change by more than rounding errors; if not, they are kept. largest: largest absolute values so far.
bool EventIteration::discrete_values_follow(Values& values, std::vector<double>& largest) {
  const std::vector<double> solved = values.variable;
  if (!discrete_.update(values)) return false;
  bool has_changed = false;
  for (const DiscreteAssignment& assignment : system_.at_events.discrete) {
    const std::size_t v = at(assignment.variable);
    const double before = solved[v], now = values.variable[v];
    if (are_same(before, now)) continue;
    largest[v] = std::max({largest[v], std::fabs(before), std::fabs(now)});
    const bool is_real = v < system_.model.variables.size() && system_.model.variables[v].type == Type::real;
    has_changed = has_changed || !is_real || !(std::fabs(now - before) <= same_value * largest[v]);
  }
  if (has_changed) return true;
  values.variable = solved;
  return false;
}

// With pre() fixed: makes discrete variables, equations and switches agree with each other.
void EventIteration::settle(Values& values, sfdae::Point& point) {
  Values before = values;
  std::vector<double> largest(values.variable.size(), 0.0);
  for (int round = 0; round < max_settling; ++round) {
    before.variable = values.variable;
    before.switches = values.switches;
    discrete_.update(values);
    const bool is_new = modes_.equations_key(values) != solved_key_;
    if (is_new) solve(values, point);
    const bool takes_literally = is_at_start_ && round < max_at_once;
    const bool has_switched =
        takes_literally ? switches_.set_literally(values) : switches_.update(values, round >= max_at_once);
    if (!has_switched && !(is_new && discrete_values_follow(values, largest))) return;
  }
  throw Failure(Outcome::not_finished, SFDAE_OK,
                "no values agree with all relations at t = " + to_text(values.t) +
                    "; these keep changing: " + changing(before, values));
}

void EventIteration::assertion_failed(const Reaction& reaction, double t) {
  const std::string text =
      place(system_.model, reaction.at) + ": assertion failed at t = " + to_text(t) + ": " + reaction.message;
  if (reaction.is_error) throw Failure(Outcome::not_finished, SFDAE_OK, text);
  const std::size_t number = static_cast<std::size_t>(&reaction - system_.reactions.data());
  if (is_reported_[number] == 0) warnings_.push_back(text);
  is_reported_[number] = 1;
}

void EventIteration::check_assertions(Values& values) {
  if (system_.reactions.empty()) return;
  discrete_.evaluate_reactions(values);
  discrete_.check_conditions(values.t);
  for (int i = 0; i < static_cast<int>(system_.reactions.size()); ++i) {
    const Reaction& reaction = system_.reactions[at(i)];
    if (reaction.kind == Action::Kind::assertion && discrete_.is_active(i) && !(discrete_.value(i) > 0.0))  // or NaN
      assertion_failed(reaction, values.t);
  }
}

// Returns whether values of the integration were reset.
bool EventIteration::react(Values& values, sfdae::Point& point, EventResult& result) {
  std::vector<int> fixed(point.x.size(), 0);
  bool is_reinitialized = false;
  check_assertions(values);
  for (int i = 0; i < static_cast<int>(system_.reactions.size()); ++i) {
    const Reaction& reaction = system_.reactions[at(i)];
    if (!discrete_.is_active(i)) continue;
    if (reaction.kind == Action::Kind::terminate) {
      result.is_terminated = true;
      result.message = reaction.message;
    } else if (reaction.kind == Action::Kind::assign) {
      result.acted.push_back(reaction.message + " (" + place(system_.model, reaction.at) + ")");
    } else if (reaction.kind == Action::Kind::reinit) {
      if (!std::isfinite(discrete_.value(i)))
        throw Failure(Outcome::not_finished, SFDAE_OK,
                      place(system_.model, reaction.at) + ": reinit of " +
                          system_.model.variables[at(reaction.variable)].name + " at t = " + to_text(values.t) +
                          ": the new value is " + to_text(discrete_.value(i)));
      const Alias& alias = system_.aliases[at(reaction.variable)];
      const auto unknown = std::find(modes_.unknowns().begin(), modes_.unknowns().end(), alias.root);
      const std::size_t j = static_cast<std::size_t>(unknown - modes_.unknowns().begin());
      point.x[j] = alias.sign * (discrete_.value(i) - alias.offset);
      fixed[j] = 1;
      is_reinitialized = true;
    }
  }
  if (is_reinitialized) {
    Values before = values;
    modes_.to_values(point, values);
    solve_keeping_states(values, point, fixed);
    switches_.forget_moved(before, values);
  }
  return is_reinitialized;
}

EventResult EventIteration::run_at_start(Values& values, sfdae::Point& point) {
  is_at_start_ = true;
  const EventResult result = run(values, point, modes_.equations_key(values));
  is_at_start_ = false;
  return result;
}

EventResult EventIteration::run(Values& values, sfdae::Point& point, const std::vector<double>& key) {
  EventResult result;
  solved_key_ = key;
  has_solved_ = false;
  discrete_.complete(values);
  discrete_.set_previous(values);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    settle(values, point);
    const bool is_reinitialized = react(values, point, result);
    const bool had_sample = std::find(values.samples.begin(), values.samples.end(), 1.0) != values.samples.end();
    const bool is_stable = !is_reinitialized && !had_sample && !discrete_.differs_from_previous(values);
    std::fill(values.samples.begin(), values.samples.end(), 0.0);
    discrete_.complete(values);
    discrete_.set_previous(values);
    if (!is_stable) continue;
    // The solver may have solved other equations here, even if the original ones hold again.
    result.needs_start = has_solved_ || modes_.equations_key(values) != key;
    return result;
  }
  throw Failure(Outcome::not_finished, SFDAE_OK,
                "the event at t = " + to_text(values.t) + " does not end: discrete variables keep changing");
}

}  // namespace sfdae::cli
