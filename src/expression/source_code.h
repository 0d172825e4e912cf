// Recorded formulas as statements of C99 or Fortran 2008.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "expression/record.h"

namespace sfdae::core {

enum class Language { C, Fortran };

// The shortest decimal number that reads as this value.
std::string source_of(double value, Language language);
// "word[3]", or "word(4)".
std::string element(const char* word, int i, Language language);

// A line of at most 100 columns as a rule, with continuation lines.
std::string wrapped(const std::string& line, Language language);

// Helper functions that statements call.
struct HelpersUsed {
  bool floor = false, modulo = false;
};

struct Assignment {
  std::string target;
  int node;
};

// `target = formula` in the names t, z, zdot, p (unknowns, their derivatives, parameters), after shared subexpressions:
// constants v0, v1, ... in C, elements of an array v in Fortran, num_values of them.
struct Statements {
  std::string text;
  int num_values = 0;
  bool uses_values_of(char name) const { return uses.find(name) != std::string::npos; }
  std::string uses;  // of 't', 'z', 'd' (zdot), 'p'
};
Statements statements_of(const Record& record, const std::vector<Assignment>& assignments, Language language,
                         HelpersUsed& helpers);

}  // namespace sfdae::core
