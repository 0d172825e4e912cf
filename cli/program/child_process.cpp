// SPDX-License-Identifier: BSD-3-Clause
#include "program/child_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <optional>

extern char** environ;

namespace sfdae::cli {

namespace {

// The process id, if the program could be started; input and output are discarded, errors go to a file.
std::optional<pid_t> spawned(const std::string& path, std::vector<std::string>& arguments, const std::string& errors,
                             short flags) {
  std::string name = path;
  std::vector<char*> pointers{name.data()};
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(), O_WRONLY | O_TRUNC, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, flags);
  pid_t child = 0;
  const int failed = ::posix_spawn(&child, path.c_str(), &actions, &attributes, pointers.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return std::nullopt;
  return child;
}

}  // namespace

std::string find_program(const std::string& name) {
  const char* const path = std::getenv("PATH");
  std::string rest = path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin";
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    const std::string candidate = rest.substr(0, colon) + "/" + name;
    if (::access(candidate.c_str(), X_OK) == 0) return candidate;
    rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
  }
  return "";
}

int run_program(const std::string& path, std::vector<std::string> arguments, const std::string& errors) {
  const std::optional<pid_t> child = spawned(path, arguments, errors, 0);
  if (!child) return -1;
  int status = 0;
  while (::waitpid(*child, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool start_program(const std::string& path, std::vector<std::string> arguments) {
  return spawned(path, arguments, "/dev/null", POSIX_SPAWN_SETSID).has_value();
}

}  // namespace sfdae::cli
