// A line on the terminal that says how far the work is.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

namespace sfdae::cli {

// Writes to standard error, ten times a second at most, and wipes its line at the end.
class ProgressBar {
 public:
  explicit ProgressBar(bool is_shown) : is_shown_(is_shown) {}
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar();

  // fraction: of the work, 0 to 1. details: what follows the bar.
  void show(double fraction, const std::string& details);

 private:
  bool is_shown_;
  bool is_line_written_ = false;
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace sfdae::cli
