// Other programs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace sfdae::cli {

// Path of a program that PATH leads to; "" if there is none.
std::string find_program(const std::string& name);

// Runs a program and waits for it; its messages are written to the file `errors`. Its exit code, -1 if it cannot be
// started or was ended by a signal.
int run_program(const std::string& path, std::vector<std::string> arguments, const std::string& errors);

// Starts a program that goes on by itself, without terminal. Whether it could be started.
bool start_program(const std::string& path, std::vector<std::string> arguments);

}  // namespace sfdae::cli
