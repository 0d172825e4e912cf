// SPDX-License-Identifier: BSD-3-Clause
#include "program/presentation.h"

#include <algorithm>
#include <limits>

#include "program/numbers.h"

namespace sfdae::cli {

namespace {

// Unknowns found by substitution follow from constraints, too.
bool has_constraints(const Result& result) { return result.characteristics.algebraic + result.num_eliminated > 0; }

// Tells which equations have to be differentiated until no constraint is hidden.
std::string meaning_of_index(const Result& result) {
  const Characteristics& values = result.characteristics;
  if (!has_constraints(result)) return "These are ordinary differential equations: there are no constraints.";
  if (values.strangeness_index == 0) return "No constraint is hidden: the algebraic unknowns follow from the others.";
  const std::string order = values.strangeness_index == 1   ? "once"
                            : values.strangeness_index == 2 ? "twice"
                                                            : std::to_string(values.strangeness_index) + " times";
  return "There are hidden constraints: they appear only after equations have been differentiated " + order +
         ", which is done numerically.";
}

std::string counts_in_words(const Result& result) {
  const Characteristics& values = result.characteristics;
  std::string text = "Of " + counted(result.num_unknowns, "unknown", "unknowns");
  if (result.num_eliminated > 0)
    text += " (" + counted(result.num_eliminated, "more is", "more are") + " found by substitution)";
  const std::string free = values.differential == 0 ? "none" : std::to_string(values.differential);
  if (values.algebraic == 0) return text + ", " + free + " can have any initial value.";
  return text + ", " + free + " can have any initial value; " +
         (values.algebraic == 1 ? "1 follows" : std::to_string(values.algebraic) + " follow") + " from constraints.";
}

std::string replaced_in_words(const Result& result) {
  return counted(result.num_replaced_states, "differentiated unknown has", "differentiated unknowns have") +
         " been replaced by what others give for " + (result.num_replaced_states == 1 ? "it" : "them") +
         ": as they stand, the equations may have a higher index.";
}

}  // namespace

std::string name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::solved: return "solved";
    case Outcome::stopped: return "stopped";
    case Outcome::invalid_model: return "invalid model";
    case Outcome::not_analyzed: return "not analyzed";
    case Outcome::not_started: return "not started";
    case Outcome::not_finished: return "not finished";
  }
  return "";
}

std::vector<ParameterValue> parameter_values(const Presentation& presentation) {
  std::map<std::string, double> values = presentation.result.parameters;
  // Parameters computed from initial equations are constant columns.
  const Trajectory& trajectory = presentation.result.trajectory;
  if (!trajectory.t.empty())
    for (std::size_t j = 0; j < trajectory.names.size(); ++j)
      values.emplace(trajectory.names[j], trajectory.values[j]);
  std::vector<ParameterValue> result;
  for (const Variable& variable : presentation.model.variables) {
    if (variable.variability != Variability::parameter) continue;
    ParameterValue parameter{&variable, std::numeric_limits<double>::quiet_NaN()};
    if (const auto known = values.find(variable.name); known != values.end()) parameter.value = known->second;
    result.push_back(parameter);
  }
  return result;
}

std::optional<int> differentiation_index(const Result& result) {
  const Characteristics& values = result.characteristics;
  if (values.undetermined > 0 || values.redundant > 0) return std::nullopt;
  return has_constraints(result) ? values.strangeness_index + 1 : 0;
}

std::vector<std::string> index_in_words(const Result& result) {
  const Characteristics& values = result.characteristics;
  if (result.num_unknowns == 0 && result.outcome == Outcome::solved)
    return {"No differential equations are left: everything is found by substitution or at events."};
  if (values.differential + values.algebraic + values.undetermined == 0) return {};
  const std::string strangeness = "trangeness index " + std::to_string(values.strangeness_index);
  const std::optional<int> index = differentiation_index(result);
  std::vector<std::string> sentences;
  sentences.push_back(index ? "Index " + std::to_string(*index) + " (s" + strangeness + ")."
                            : "S" + strangeness + ".");
  if (result.num_replaced_states > 0) sentences.push_back(replaced_in_words(result));
  sentences.push_back(meaning_of_index(result));
  sentences.push_back(counts_in_words(result));
  if (values.undetermined > 0)
    sentences.push_back(counted(values.undetermined, "component", "components") +
                        " of the solution can be chosen freely: there are too few equations for them.");
  if (values.redundant > 0)
    sentences.push_back(counted(values.redundant, "equation follows", "equations follow") + " from the others.");
  return sentences;
}

std::string safety_in_words(const Result& result) {
  const auto count = [&result](int verdict) {
    return static_cast<int>(std::count_if(result.decisions.begin(), result.decisions.end(),
                                          [verdict](const Decision& d) { return d.verdict == verdict; }));
  };
  if (result.decisions.empty()) return "";
  double gap = std::numeric_limits<double>::infinity();
  for (const Decision& decision : result.decisions) gap = std::min(gap, decision.gap);
  const int all = static_cast<int>(result.decisions.size());
  std::string text = counted(all, "rank decision", "rank decisions") + ": ";
  if (count(SFDAE_VERDICT_UNCLEAR) > 0) text += std::to_string(count(SFDAE_VERDICT_UNCLEAR)) + " not clear";
  else if (count(SFDAE_VERDICT_CONFIRMED) > 0) text += "close ones were confirmed by a second computation";
  else text += all == 1 ? "clear" : "all clear";
  if (gap < 1e300)
    text += "; in the closest one, what was kept is " + short_text(gap, 2) + " times what was dropped or is rounding";
  return text + ".";
}

std::string subject_of(const Decision& decision) {
  switch (decision.what) {
    case SFDAE_DECISION_STAGE: return "derivatives of order " + std::to_string(decision.stage);
    case SFDAE_DECISION_A2: return "constraints";
    case SFDAE_DECISION_ET2: return "differential equations";
    default: return "derivative array";
  }
}

std::string verdict_of(const Decision& decision) {
  switch (decision.verdict) {
    case SFDAE_VERDICT_CLEAR: return "clear";
    case SFDAE_VERDICT_CONFIRMED: return "confirmed";
    case SFDAE_VERDICT_UNCLEAR: return "unclear";
    default: return "by rank_tol";
  }
}

}  // namespace sfdae::cli
