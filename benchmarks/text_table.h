// Rows of text on standard output, in aligned columns or separated by commas.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace sfdae_bench {

struct Column {
  std::string title;
  int width;  // negative: aligned to the left
};

class TextTable {
 public:
  TextTable(std::vector<Column> columns, bool csv) : columns_(std::move(columns)), csv_(csv) {
    std::vector<std::string> titles;
    for (const Column& column : columns_) titles.push_back(column.title);
    row(titles);
  }
  void row(const std::vector<std::string>& cells) const {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const std::string cell = i < cells.size() ? cells[i] : "";
      if (csv_) std::printf("%s%s", i > 0 ? "," : "", quoted(cell).c_str());
      else std::printf("%s%*s", i > 0 ? " " : "", columns_[i].width, cell.empty() ? "-" : cell.c_str());
    }
    std::printf("\n");
    std::fflush(stdout);
  }

 private:
  static std::string quoted(const std::string& cell) {
    return cell.find(',') == std::string::npos ? cell : '"' + cell + '"';
  }
  std::vector<Column> columns_;
  bool csv_;
};

// Three digits or all before the point; empty if it is not a number.
inline std::string text(double value) {
  if (std::isnan(value)) return "";
  char digits[32];
  std::snprintf(digits, sizeof digits, std::fabs(value) >= 99.95 ? "%.0f" : "%#.3g", value);
  return digits;
}
inline std::string text(int value) { return std::to_string(value); }

}  // namespace sfdae_bench
