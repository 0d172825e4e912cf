// SPDX-License-Identifier: BSD-3-Clause
#include "program/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "program/exit_codes.h"

namespace sfdae::cli {

namespace {

bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

// The mode of a newly created file, or of the file that is replaced.
mode_t mode_for(const std::string& target) {
  struct stat status {};
  if (::stat(target.c_str(), &status) == 0) return status.st_mode & 07777;
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return 0666 & ~mask;
}

}  // namespace

OutputFile::OutputFile(const std::string& path) : path_(path), target_(path) {
  if (path == "-") {
    descriptor_ = ::dup(STDOUT_FILENO);
    if (descriptor_ < 0) fail();
    return;
  }
  std::error_code error;
  const std::filesystem::path followed = std::filesystem::weakly_canonical(path, error);
  if (!error) target_ = followed.string();
  const std::filesystem::file_status status = std::filesystem::status(target_, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail();
    return;
  }
  if (std::filesystem::exists(status) && ::access(target_.c_str(), W_OK) != 0) fail();
  // The extension is kept, because programs recognize formats by it.
  const std::string ending = std::filesystem::path(target_).extension().string();
  std::string pattern = target_ + ".XXXXXX" + ending;
  descriptor_ = ::mkostemps(pattern.data(), static_cast<int>(ending.size()), O_CLOEXEC);
  if (descriptor_ < 0) fail();
  temporary_ = pattern;
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::commit(std::string_view text) {
  if (!write_all(descriptor_, text)) fail();
  commit();
}

void OutputFile::commit() {
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) fail();
  if (temporary_.empty()) return;
  if (::chmod(temporary_.c_str(), mode_for(target_)) != 0) fail();
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail();
  temporary_.clear();
}

void OutputFile::fail() const {
  throw ProgramError(not_written, "cannot write " + (path_ == "-" ? std::string("to standard output") : path_) +
                                      ": " + std::strerror(errno));
}

void write_to_standard_output(std::string_view text) {
  if (!write_all(STDOUT_FILENO, text))
    throw ProgramError(not_written, std::string("cannot write to standard output: ") + std::strerror(errno));
}

bool is_standard_output_terminal() { return ::isatty(STDOUT_FILENO) == 1; }

bool is_standard_error_terminal() { return ::isatty(STDERR_FILENO) == 1; }

}  // namespace sfdae::cli
