// The commands of the program, one function each. They return exit codes and throw ProgramError and ModelError.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "program/arguments.h"

namespace sfdae::cli {

int check_command(const Arguments& arguments);
int analyze_command(const Arguments& arguments);
int solve_command(const Arguments& arguments);
int sweep_command(const Arguments& arguments);

}  // namespace sfdae::cli
