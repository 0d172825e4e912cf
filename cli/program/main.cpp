// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "modelica/read_model.h"
#include "simulation/simulation.h"

int main(int count, char** arguments) {
  CLI::App app("Solves differential-algebraic equations of model files.", "sfdae");
  CLI11_PARSE(app, count, arguments);
  return 0;
}
