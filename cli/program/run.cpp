// SPDX-License-Identifier: BSD-3-Clause
#include "program/run.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <iterator>

#include "modelica/read_model.h"
#include "program/numbers.h"
#include "program/presentation.h"

namespace sfdae::cli {

FlatModel read_model_of(const Arguments& arguments) {
  std::error_code error;
  if (std::filesystem::is_directory(arguments.model, error))
    throw ProgramError(wrong_use, arguments.model + " is a directory, not a model");
  if (arguments.model != "-") return read_model_file(arguments.model);
  const std::string text{std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>()};
  return read_model(text, "standard input");
}

void print_warnings(const Arguments& arguments, const std::vector<std::string>& warnings) {
  if (arguments.is_quiet) return;
  for (const std::string& warning : warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
}

ExitCode exit_code_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::solved: return solved;
    case Outcome::stopped: return interrupted;
    case Outcome::invalid_model: return wrong_use;
    case Outcome::not_analyzed: return not_analyzed;
    case Outcome::not_started: return not_started;
    case Outcome::not_finished: return not_solved;
  }
  return not_solved;
}

void print_reason(const FlatModel& model, const Result& result) {
  if (result.outcome == Outcome::solved) return;
  std::string text = "sfdae: " + model.name + " is " +
                     (result.outcome == Outcome::invalid_model ? "no valid model" : name_of(result.outcome));
  if (!result.trajectory.t.empty()) text += ", reached t = " + short_text(result.trajectory.t.back(), 9);
  if (!result.message.empty()) text += ": " + result.message;
  std::fprintf(stderr, "%s\n", text.c_str());
}

double start_of(const Settings& settings, const FlatModel& model) {
  return std::isnan(settings.start) ? model.experiment.start.value_or(0.0) : settings.start;
}

double stop_of(const Settings& settings, const FlatModel& model) {
  return std::isnan(settings.stop) ? model.experiment.stop.value_or(1.0) : settings.stop;
}

}  // namespace sfdae::cli
