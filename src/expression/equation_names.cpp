// Names that users give their equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/equation_names.h"

#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Bytes: eight names of this length, the most in a message, leave room for its other text.
constexpr std::size_t longest = 80;

std::string for_messages(std::string name) {
  for (char& c : name)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  if (name.size() <= longest) return name;
  // Not within a character of UTF-8, whose bytes after the first are 10xxxxxx.
  std::size_t end = longest - 3;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0u) == 0x80u) --end;
  return name.substr(0, end) + "...";
}

}  // namespace

EquationNames::EquationNames(std::vector<std::string> names) {
  for (std::string& name : names) name = for_messages(std::move(name));
  names_ = std::make_shared<const std::vector<std::string>>(std::move(names));
}

std::string EquationNames::appended_to(std::string text, int equation) const {
  const std::string& name = (*this)[equation];
  return name.empty() ? text : text + " (" + name + ")";
}

std::string EquationNames::row(int equation) const {
  return (*this)[equation].empty() ? "row " + std::to_string(equation) : in_words(equation);
}

const std::string& EquationNames::operator[](int equation) const {
  static const std::string none;
  const bool is_known = names_ != nullptr && equation >= 0 && index(equation) < names_->size();
  return is_known ? (*names_)[index(equation)] : none;
}

}  // namespace sfdae::core
