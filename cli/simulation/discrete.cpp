// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/discrete.h"

#include <cmath>

#include "simulation/failure.h"
#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Limit on the sweeps over interdependent discrete variables, which take few values.
constexpr int max_sweeps = 100;

}  // namespace

Discrete::Discrete(const System& system)
    : system_(system),
      assignments_(system.formulas),
      initial_(system.formulas),
      reactions_(system.formulas),
      others_(system.formulas) {
  for (const DiscreteAssignment& assignment : system.at_events.discrete)
    assignments_.add_assignment(assignment.variable, assignment.value);
  for (const DiscreteAssignment& assignment : system.at_events.initial) initial_.add(assignment.value);
  for (const Reaction& reaction : system.reactions) {
    reactions_.add(reaction.active);
    reactions_.add(reaction.value >= 0 ? reaction.value : reaction.active);
  }
  for (int v = 0; v < static_cast<int>(system.values.size()); ++v) {
    const FormulaNode& node = system.formulas[system.values[at(v)]];
    if (node.operation != Operation::variable || node.index != v) others_.add_assignment(v, system.values[at(v)]);
  }
}

bool Discrete::update(Values& values) {
  if (system_.at_events.discrete.empty()) return false;
  bool has_changed = false;
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    before_ = values.variable;
    assignments_.run(values);
    const bool changes = !are_same(before_, values.variable);
    has_changed = has_changed || changes;
    if (!changes || !system_.at_events.has_loop) return has_changed;
  }
  std::string names;
  for (const DiscreteAssignment& assignment : system_.at_events.discrete)
    if (at(assignment.variable) < system_.model.variables.size() &&
        !are_same(before_[at(assignment.variable)], values.variable[at(assignment.variable)]))
      names += (names.empty() ? "" : ", ") + system_.model.variables[at(assignment.variable)].name;
  throw Failure(
      Outcome::not_finished, SFDAE_OK,
      "discrete variables depend on each other and do not settle at t = " + to_text(values.t) + ": " + names);
}

bool Discrete::set_initial(Values& values) {
  if (system_.at_events.initial.empty()) return false;
  initial_.run(values);
  bool has_changed = false;
  for (int i = 0; i < initial_.size(); ++i) {
    const int v = system_.at_events.initial[at(i)].variable;
    if (are_same(values.previous[at(v)], initial_[i])) continue;
    values.previous[at(v)] = initial_[i];
    values.variable[at(v)] = initial_[i];
    has_changed = true;
  }
  return has_changed;
}

void Discrete::check_conditions(double t) const {
  for (int i = 0; i < static_cast<int>(system_.reactions.size()); ++i)
    if (std::isnan(reactions_[2 * i]))
      throw Failure(Outcome::not_finished, SFDAE_OK,
                    place(system_.model, system_.reactions[at(i)].at) +
                        ": the condition of this when clause at t = " + to_text(t) +
                        " is neither true nor false, since a part of it is not defined");
}

bool Discrete::differs_from_previous(const Values& values) const {
  for (const DiscreteAssignment& assignment : system_.at_events.discrete)
    if (!are_same(values.variable[at(assignment.variable)], values.previous[at(assignment.variable)])) return true;
  return false;
}

}  // namespace sfdae::cli
