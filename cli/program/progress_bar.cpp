// SPDX-License-Identifier: BSD-3-Clause
#include "program/progress_bar.h"

#include <algorithm>
#include <cstdio>

namespace sfdae::cli {

namespace {

constexpr std::size_t bar_width = 24, max_details = 48;  // together less than 80 columns

}  // namespace

ProgressBar::~ProgressBar() {
  if (is_line_written_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(double fraction, const std::string& details) {
  const auto now = std::chrono::steady_clock::now();
  if (!is_shown_ || now < next_) return;
  next_ = now + std::chrono::milliseconds(100);
  is_line_written_ = true;
  const auto filled = static_cast<std::size_t>(std::clamp(fraction, 0.0, 1.0) * static_cast<double>(bar_width));
  const std::string line = "\r[" + std::string(filled, '#') + std::string(bar_width - filled, '.') + "] " +
                           details.substr(0, max_details) + "\033[K";
  std::fputs(line.c_str(), stderr);
}

}  // namespace sfdae::cli
