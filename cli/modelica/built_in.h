// The built-in functions and operators of the language.
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

// None if there is no function of that name.
std::optional<Value> call_mathematics(Elaboration& e, const Environment& in, const Call& call);
std::optional<Value> call_array_function(Elaboration& e, const Environment& in, const Call& call);
std::optional<Value> call_event_operator(Elaboration& e, const Environment& in, const Call& call);

// Supported external functions on strings; none if it is not one of them.
std::optional<Value> call_string_function(Elaboration& e, const Call& call);
// External functions that only print messages.
bool only_shows_text(const std::string& external);

// Fails unless the number of arguments lies in these bounds.
void check_count(const Elaboration& e, const Call& call, size_t min, size_t max);
// The scalar argument k, for example a condition.
Expression scalar_argument(const Elaboration& e, const Call& call, size_t k, Kind kind);
int integer_argument(Elaboration& e, const Call& call, size_t k);

// The built-in function equivalent to an external one of the C library or of the language's mathematical functions.
std::optional<std::string> built_in_of_external(const std::string& name);

}  // namespace sfdae::cli
