// Presentation of a solution: text for people, CSV, JSON, a page.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/flat_model.h"
#include "simulation/simulation.h"

namespace sfdae::cli {

struct Presentation {
  const FlatModel& model;
  const Result& result;                 // its trajectory has all variables
  const Trajectory& trajectory;         // only the selected variables
  std::map<std::string, double> given;  // by --set
};

// A parameter and its value in this run.
struct ParameterValue {
  const Variable* variable = nullptr;
  double value = 0.0;  // NaN: not known
};

std::vector<ParameterValue> parameter_values(const Presentation& presentation);

// "solved", "not started", ...
std::string name_of(Outcome outcome);

// The differentiation index of the model, unless states have been replaced; none if the equations are underdetermined
// or redundant.
std::optional<int> differentiation_index(const Result& result);

// Sentences that explain the index of this model; none if it was not determined.
std::vector<std::string> index_in_words(const Result& result);

// A sentence on the margins of the rank decisions; "" without decisions.
std::string safety_in_words(const Result& result);

// Both texts, as lines.
std::string index_text(const Result& result);

// The subject of a decision in a word: "stage", "constraints", ...
std::string subject_of(const Decision& decision);
std::string verdict_of(const Decision& decision);

// One line: the problem, the time reached, the number of steps.
std::string headline(const Presentation& presentation);

// For people: the headline, the index, statistics, first and last values.
std::string summary_text(const Presentation& presentation);

// For people: the index, the library's report with its rank decisions, initial values.
std::string analysis_text(const Presentation& presentation);

// Rows of equally many cells as lines with aligned columns.
std::string aligned(const std::vector<std::vector<std::string>>& rows);

// A row of names, then a row for each output.
std::string csv_text(const Trajectory& trajectory);

// A field of CSV, quoted if necessary.
std::string csv_field(const std::string& text);

std::string json_text(const Presentation& presentation);

// A self-contained page for the browser.
std::string html_text(const Presentation& presentation);

}  // namespace sfdae::cli
