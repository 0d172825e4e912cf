// Exit codes of the program, and the exception that carries one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace sfdae::cli {

enum ExitCode {
  solved = 0,
  not_solved = 1,    // the integration ended early, or some instances of a sweep are not solved
  wrong_use = 2,     // invalid arguments, or a model that cannot be read or is invalid
  not_analyzed = 3,  // the index could not be determined
  not_started = 4,   // no consistent initial values
  not_written = 5,   // results could not be written
  interrupted = 130  // as shells report SIGINT
};

// Ends the program with a message.
class ProgramError : public std::runtime_error {
 public:
  ProgramError(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace sfdae::cli
