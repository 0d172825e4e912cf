// Names that users give their equations, and their form in messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace sfdae::core {

// Copies share the names.
class EquationNames {
 public:
  // No names: messages use numbers.
  EquationNames() = default;
  // An empty string stands for no name. Control characters become spaces, and long names are cut.
  explicit EquationNames(std::vector<std::string> names);

  // The text, and the name of the equation in parentheses if it has one: "equation 7 (balance of mass)".
  std::string appended_to(std::string text, int equation) const;
  std::string in_words(int equation) const { return appended_to("equation " + std::to_string(equation), equation); }
  // Name of the equation's row in a matrix: "row 7", or "equation 7 (balance of mass)".
  std::string row(int equation) const;
  // Empty if it has none.
  const std::string& operator[](int equation) const;

 private:
  std::shared_ptr<const std::vector<std::string>> names_;
};

}  // namespace sfdae::core
