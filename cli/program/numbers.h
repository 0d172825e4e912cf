// Numbers as text, the same in every locale.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <string_view>

namespace sfdae::cli {

// The shortest text that reads back as the same number; "nan", "inf", "-inf".
std::string full_text(double value);

// With the given number of significant digits, for people.
std::string short_text(double value, int digits = 6);

// "1 unknown", "2 unknowns".
std::string counted(std::integral auto count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

// A finite number that fills the text, with an optional sign.
std::optional<double> parse_number(std::string_view text);

}  // namespace sfdae::cli
