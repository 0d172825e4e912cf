// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/initial_state.h"

#include <algorithm>

#include "simulation/text.h"

namespace sfdae::cli {

namespace {

constexpr int max_rounds = 50;

}  // namespace

void InitialState::set_start_values(double t, Values& values) const {
  values.t = t;
  values.is_initial = true;
  for (std::size_t v = 0; v < system_.model.variables.size(); ++v) values.variable[v] = system_.starts.numbers[v];
  for (int v : modes_.unknowns())
    if (v >= 0) values.variable[at(v)] = system_.starts.numbers[at(v)];
  values.previous = values.variable;
}

// reinit(x, e) in a when clause that acts initially is x = e.
std::vector<Condition> InitialState::reinitializations(Values& values) {
  std::vector<Condition> result;
  discrete_.evaluate_reactions(values);
  for (int i = 0; i < static_cast<int>(system_.reactions.size()); ++i) {
    const Reaction& reaction = system_.reactions[at(i)];
    if (reaction.kind != Action::Kind::reinit || !discrete_.is_active(i)) continue;
    const Alias& alias = system_.aliases[at(reaction.variable)];
    const auto unknown = std::find(modes_.unknowns().begin(), modes_.unknowns().end(), alias.root);
    if (alias.root < 0 || unknown == modes_.unknowns().end()) continue;
    Condition condition;
    condition.unknown = static_cast<int>(unknown - modes_.unknowns().begin());
    condition.value = alias.sign * (discrete_.value(i) - alias.offset);
    condition.text = "reinit of " + system_.model.variables[at(reaction.variable)].name;
    condition.at = reaction.at;
    result.push_back(condition);
  }
  return result;
}

void InitialState::find(double t, Values& values, std::vector<std::string>& warnings) {
  set_start_values(t, values);
  Initialization initialization(system_, modes_, calls_);
  sfdae::Point point;
  switches_.set_literally(values);
  discrete_.set_initial(values);
  discrete_.update(values);
  bool is_settled = false;
  for (int round = 0; round < max_rounds && !is_settled; ++round) {
    const std::vector<double> key = modes_.equations_key(values);
    initialization.solve(values, point, reinitializations(values));
    const bool switched = round < max_rounds / 2 ? switches_.set_literally(values) : switches_.update(values, true);
    const bool assigned = discrete_.set_initial(values);
    is_settled = !discrete_.update(values) && !assigned && !switched && modes_.equations_key(values) == key;
  }
  if (!is_settled)
    throw Failure(Outcome::not_started, SFDAE_OK,
                  "no initial values agree with all relations and discrete equations");
  warnings.insert(warnings.end(), initialization.warnings().begin(), initialization.warnings().end());
  values.is_initial = false;
  discrete_.complete(values);
}

}  // namespace sfdae::cli
