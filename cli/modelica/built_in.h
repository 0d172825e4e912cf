// The functions and operators that the language brings.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "modelica/elaboration.h"
#include "modelica/record.h"

namespace sfdae::cli {

struct Call {
  std::string name;
  std::vector<Argument> arguments;
  Location at;
};

// None: there is none of that name.
std::optional<Value> call_mathematics(Elaboration& e, const Environment& in, const Call& call);
std::optional<Value> call_array_function(Elaboration& e, const Environment& in, const Call& call);
std::optional<Value> call_event_operator(Elaboration& e, const Environment& in, const Call& call);

// External functions on strings that are known; none: it is no such function.
std::optional<Value> call_string_function(Elaboration& e, const Call& call);
// External functions without results that matter for the solution: messages.
bool only_shows_text(const std::string& external);

// Fails unless the number of arguments lies in these bounds.
void check_count(const Elaboration& e, const Call& call, size_t min, size_t max);
// Of a condition or another scalar argument.
Expression scalar_argument(const Elaboration& e, const Call& call, size_t k, Kind kind);
int integer_argument(Elaboration& e, const Call& call, size_t k);

// What an external function of that name does, if it is one of C's or of the language's mathematical functions.
std::optional<std::string> built_in_of_external(const std::string& name);

}  // namespace sfdae::cli
