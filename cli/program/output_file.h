// A file that is written completely or not at all.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace sfdae::cli {

// Created in the folder of its target, so that failures show before the work begins, and renamed to it at the end.
// Devices and pipes are written directly, and "-" is standard output.
class OutputFile {
 public:
  // Throws ProgramError if nothing can be written there.
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  // The path for another program that writes the file; call commit() without text afterwards.
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
