// A progress bar on the terminal.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

namespace sfdae::cli {

// Writes to standard error, at most ten times a second, and erases its line at the end.
class ProgressBar {
 public:
  explicit ProgressBar(bool is_shown) : is_shown_(is_shown) {}
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar();

  // fraction: completed part of the work, 0 to 1. details: text after the bar.
  void show(double fraction, const std::string& details);

 private:
  bool is_shown_;
  bool is_line_written_ = false;
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace sfdae::cli
