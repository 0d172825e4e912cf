// Comma-separated values (RFC 4180), lines end with a line feed.
// SPDX-License-Identifier: BSD-3-Clause
#include "program/numbers.h"
#include "program/presentation.h"

namespace sfdae::cli {

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string csv_text(const Trajectory& trajectory) {
  std::string text = "time";
  for (const std::string& name : trajectory.names) text += "," + csv_field(name);
  text += "\n";
  const std::size_t columns = trajectory.names.size();
  for (std::size_t k = 0; k < trajectory.t.size(); ++k) {
    text += full_text(trajectory.t[k]);
    for (std::size_t j = 0; j < columns; ++j) text += "," + full_text(trajectory.values[k * columns + j]);
    text += "\n";
  }
  return text;
}

}  // namespace sfdae::cli
