// Runs other programs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace sfdae::cli {

// Path of a program found by PATH; "" if there is none.
std::string find_program(const std::string& name);

// Runs a program and waits for it; its messages are written to the file `errors`. Returns its exit code, or -1 if it
// could not be started or was ended by a signal.
int run_program(const std::string& path, std::vector<std::string> arguments, const std::string& errors);

// Starts a detached program without a terminal. Returns whether it could be started.
bool start_program(const std::string& path, std::vector<std::string> arguments);

}  // namespace sfdae::cli
