// A file that is written completely or not at all.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace sfdae::cli {

// Made beside its target, so that what cannot be written is known before the work begins, and renamed to it at the
// end. What is no regular file (a device, a pipe) is written directly, and "-" is standard output.
class OutputFile {
 public:
  // Throws ProgramError if nothing can be written there.
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  // Where to write if another program does it. After that commit() with no text.
  const std::string& temporary_path() const { return temporary_; }
  const std::string& path() const { return path_; }

  // Throws ProgramError if the text cannot be written.
  void commit(std::string_view text);
  void commit();

 private:
  [[noreturn]] void fail() const;

  std::string path_;       // as the user gave it
  std::string target_;     // symbolic links followed
  std::string temporary_;  // "" if written directly
  int descriptor_ = -1;
};

// Writes to standard output; throws ProgramError if that fails.
void write_to_standard_output(std::string_view text);

bool is_standard_output_terminal();
bool is_standard_error_terminal();

}  // namespace sfdae::cli
