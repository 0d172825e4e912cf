// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "program/presentation.h"

namespace sfdae::cli {

namespace {

using Json = nlohmann::ordered_json;

Json index_json(const Result& result) {
  const Characteristics& values = result.characteristics;
  const std::vector<std::string> words = index_in_words(result);
  if (words.empty()) return nullptr;
  Json json{{"strangeness_index", values.strangeness_index},
            {"differentiation_index", nullptr},
            {"differential", values.differential},
            {"algebraic", values.algebraic},
            {"undetermined", values.undetermined},
            {"redundant", values.redundant},
            {"replaced_states", result.num_replaced_states},
            {"smallest_gap", values.smallest_gap},
            {"words", words},
            {"safety", safety_in_words(result)}};
  if (const std::optional<int> index = differentiation_index(result)) json["differentiation_index"] = *index;
  return json;
}

Json decisions_json(const Result& result) {
  Json json = Json::array();
  for (const Decision& d : result.decisions)
    json.push_back({{"time", d.t},
                    {"level", d.level},
                    {"subject", subject_of(d)},
                    {"rows", d.rows},
                    {"columns", d.columns},
                    {"rank", d.rank},
                    {"kept", d.kept},
                    {"dropped", d.dropped},
                    {"noise", d.noise},
                    {"threshold", d.threshold},
                    {"gap", d.gap},
                    {"verdict", verdict_of(d)}});
  return json;
}

Json statistics_json(const Result& result) {
  const Statistics& s = result.statistics;
  return {{"unknowns", result.num_unknowns},
          {"eliminated", result.num_eliminated},
          {"steps", s.steps},
          {"error_failures", s.error_failures},
          {"other_failures", s.other_failures},
          {"reductions", s.reductions},
          {"factorizations", s.factorizations},
          {"evaluations", s.evaluations_F},
          {"linearizations", s.linearizations},
          {"first_step", s.first_step},
          {"last_step", s.last_step},
          {"last_order", s.last_order}};
}

Json parameters_json(const Presentation& presentation) {
  Json json = Json::array();
  for (const ParameterValue& parameter : parameter_values(presentation)) {
    const Variable& variable = *parameter.variable;
    json.push_back({{"name", variable.name},
                    {"value", parameter.value},
                    {"unit", variable.unit},
                    {"description", variable.description},
                    {"given", presentation.given.contains(variable.name)}});
  }
  return json;
}

Json variables_json(const Trajectory& trajectory) {
  Json json = Json::array();
  const std::size_t columns = trajectory.names.size();
  for (std::size_t j = 0; j < columns; ++j) {
    Json values = Json::array();
    for (std::size_t k = 0; k < trajectory.t.size(); ++k) values.push_back(trajectory.values[k * columns + j]);
    json.push_back({{"name", trajectory.names[j]},
                    {"unit", trajectory.units[j]},
                    {"description", trajectory.descriptions[j]},
                    {"discrete", static_cast<bool>(trajectory.is_discrete[j])},
                    {"values", std::move(values)}});
  }
  return json;
}

Json events_json(const Result& result) {
  Json json = Json::array();
  for (const HappenedEvent& event : result.events) json.push_back({{"time", event.t}, {"text", event.text}});
  return json;
}

}  // namespace

std::string json_text(const Presentation& presentation) {
  const Result& result = presentation.result;
  Json warnings = presentation.model.warnings;
  for (const std::string& warning : result.warnings) warnings.push_back(warning);
  const Json json{{"sfdae", sfdae_version()},
                  {"model", presentation.model.name},
                  {"description", presentation.model.description},
                  {"file", presentation.model.file},
                  {"outcome", name_of(result.outcome)},
                  {"status", sfdae_status_name(result.status)},
                  {"message", result.message},
                  {"headline", headline(presentation)},
                  {"warnings", std::move(warnings)},
                  {"index", index_json(result)},
                  {"decisions", decisions_json(result)},
                  {"report", result.report},
                  {"statistics", statistics_json(result)},
                  {"parameters", parameters_json(presentation)},
                  {"events", events_json(result)},
                  {"time", presentation.trajectory.t},
                  {"variables", variables_json(presentation.trajectory)}};
  // NaN and infinities become null; invalid UTF-8 is replaced.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sfdae::cli
