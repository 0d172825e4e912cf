// What is shown of a solution, and how: as text for people, CSV, JSON, a page.
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
  const Trajectory& trajectory;         // of the variables that are wanted
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

// The differentiation index of the model, unless states have been replaced; none where the equations leave something
// undetermined or follow from others.
std::optional<int> differentiation_index(const Result& result);

// What the index means here, in sentences; none if it was not determined.
std::vector<std::string> index_in_words(const Result& result);

// How safe the rank decisions are, in a sentence; "" without decisions.
std::string safety_in_words(const Result& result);

// Both, as lines.
std::string index_text(const Result& result);

// "stage", "constraints", ...: what a decision was about, in a word.
std::string subject_of(const Decision& decision);
std::string verdict_of(const Decision& decision);

// One line: what was solved, how far, in how many steps.
std::string headline(const Presentation& presentation);

// For people: the headline, the index, statistics, first and last values.
std::string summary_text(const Presentation& presentation);

// For people: the index, the library's report with its rank decisions, initial values.
std::string analysis_text(const Presentation& presentation);

// Rows of cells, as many in each, as lines with columns one below the other.
std::string aligned(const std::vector<std::vector<std::string>>& rows);

// A row of names, then a row for each output.
std::string csv_text(const Trajectory& trajectory);

// A field of CSV, quoted where it has to be.
std::string csv_field(const std::string& text);

std::string json_text(const Presentation& presentation);

// A page for the browser that needs nothing else.
std::string html_text(const Presentation& presentation);

}  // namespace sfdae::cli
