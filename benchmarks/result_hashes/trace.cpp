// SPDX-License-Identifier: BSD-3-Clause
#include "trace.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

namespace sfdae_bench {

Words::Words(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  const std::string arrow = " => ";
  for (std::string line; std::getline(file, line);) {
    if (line.empty()) continue;
    const std::size_t at = line.find(arrow);
    if (at == std::string::npos || at == 0) throw std::runtime_error(path + ": not of the form old => new: " + line);
    rules_.emplace_back(line.substr(0, at), line.substr(at + arrow.size()));
  }
}

std::string Words::applied_to(std::string text) const {
  for (const auto& [from, to] : rules_)
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  return text;
}

void Trace::numbers(const char* what, const double* values, std::size_t count) {
  char digits[32];
  line_ += what;
  for (std::size_t i = 0; i < count; ++i) {
    // The sign of NaN means nothing.
    if (std::isnan(values[i])) std::snprintf(digits, sizeof digits, " nan");
    else std::snprintf(digits, sizeof digits, " %.17g", values[i]);
    line_ += digits;
  }
  end_line();
}

void Trace::integer(const char* what, long long value) {
  line_ += what;
  line_ += ' ';
  line_ += std::to_string(value);
  end_line();
}

void Trace::text(const char* what, const std::string& value) {
  line_ += what;
  line_ += ": " + words_.applied_to(value);
  end_line();
}

void Trace::end_line() {
  line_ += '\n';
  for (const char c : line_) hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  if (prints_) std::fputs(line_.c_str(), stdout);
  line_.clear();
}

}  // namespace sfdae_bench
