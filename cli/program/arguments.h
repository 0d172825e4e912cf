// The command line.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "simulation/simulation.h"

namespace sfdae::cli {

enum class Command { check, analyze, solve, sweep };

struct Arguments {
  Command command = Command::check;
  std::string model;                     // path, or "-" for standard input
  Settings settings;                     // without values and progress
  std::vector<std::string> assignments;  // --set: name=value, name=start:step:stop, name=value,value,...
  std::vector<std::string> variables;    // --variables: names or patterns; empty: all
  std::string csv, json, html, plot;     // paths; "": not wanted
  int jobs = 0;                          // threads of a sweep; 0: as many as there are processors
  bool is_quiet = false;
  bool lists_names = false;  // for check
  bool shows_page = false;   // for the browser
};

// The command line, or an exit code if it is invalid or needs no run; messages have been printed then.
std::variant<Arguments, int> parse_arguments(int count, char** arguments);

}  // namespace sfdae::cli
