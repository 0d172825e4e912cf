// Functions shared by the commands: reading the model, messages, exit codes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "program/arguments.h"
#include "program/exit_codes.h"

namespace sfdae::cli {

// Throws ModelError.
FlatModel read_model_of(const Arguments& arguments);

// Writes warnings to standard error, unless the program is to be quiet.
void print_warnings(const Arguments& arguments, const std::vector<std::string>& warnings);

ExitCode exit_code_of(Outcome outcome);

// Writes the reason why a model is not solved to standard error; nothing if it is solved.
void print_reason(const FlatModel& model, const Result& result);

// Start and stop time of a run.
double start_of(const Settings& settings, const FlatModel& model);
double stop_of(const Settings& settings, const FlatModel& model);

}  // namespace sfdae::cli
