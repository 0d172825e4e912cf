// Names of a model's variables on the command line.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "model/flat_model.h"
#include "simulation/simulation.h"

namespace sfdae::cli {

// A --set and its values, at least one.
struct ParameterChoice {
  std::string name;
  std::vector<double> values;
};

// Throws ProgramError unless every text is NAME=VALUE, NAME=START:STEP:STOP or NAME=VALUE,VALUE,... with the name of a
// variable that can be set, each once.
std::vector<ParameterChoice> parse_assignments(const std::vector<std::string>& texts, const FlatModel& model);

// The assignments if each has exactly one value; throws ProgramError otherwise.
std::map<std::string, double> single_values(const std::vector<ParameterChoice>& assignments);

// Tells for each variable of the model whether it is selected by one of the names or patterns, separated by commas
// outside brackets. No names: all but constants and parameters. Throws ProgramError if a name matches no variable.
std::map<std::string, bool> wanted_variables(const std::vector<std::string>& names, const FlatModel& model);

// A column for every selected variable, in the order of the model; NaN for unknown values.
Trajectory selected(const FlatModel& model, const Result& result, const std::map<std::string, bool>& wanted);

}  // namespace sfdae::cli
