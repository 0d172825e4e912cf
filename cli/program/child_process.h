// Other programs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace sfdae::cli {

// Path of a program that PATH leads to; "" if there is none.
std::string find_program(const std::string& name);

// Runs a program and waits for it; output and errors are written to the given files. Its exit code, -1 if it cannot be
// started or was ended by a signal.
int run_program(const std::string& path, std::vector<std::string> arguments, const std::string& errors);

}  // namespace sfdae::cli
