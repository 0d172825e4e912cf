// The program sfdae: solves model files.
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>

#include "program/commands.h"
#include "program/exit_codes.h"

namespace {

int run(const sfdae::cli::Arguments& arguments) {
  using sfdae::cli::Command;
  switch (arguments.command) {
    case Command::check: return sfdae::cli::check_command(arguments);
    case Command::analyze: return sfdae::cli::analyze_command(arguments);
    case Command::solve: return sfdae::cli::solve_command(arguments);
    case Command::sweep: return sfdae::cli::sweep_command(arguments);
  }
  return sfdae::cli::wrong_use;
}

int failed(const char* text, int code) {
  std::fprintf(stderr, "%s\n", text);
  return code;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    const auto parsed = sfdae::cli::parse_arguments(count, arguments);
    if (const int* const code = std::get_if<int>(&parsed)) return *code;
    return run(std::get<sfdae::cli::Arguments>(parsed));
  } catch (const sfdae::cli::ModelError& error) {
    return failed(error.what(), sfdae::cli::wrong_use);
  } catch (const sfdae::cli::ProgramError& error) {
    return failed((std::string("sfdae: ") + error.what()).c_str(), error.code());
  } catch (const std::bad_alloc&) {
    return failed("sfdae: out of memory", sfdae::cli::not_solved);
  } catch (const std::exception& error) {
    return failed((std::string("sfdae: internal error: ") + error.what()).c_str(), sfdae::cli::not_solved);
  }
}
