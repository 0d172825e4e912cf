// Records, constants of packages, and attributes of variables.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "modelica/elaboration.h"

namespace sfdae::cli {

void set_attribute(Elaboration& e, Variable& variable, const std::string& name, const Value& value, Location at);

Value value_of_global(Elaboration& e, const syntax::Declaration& declaration, Scope& package);

struct Argument {
  std::string name;  // empty: by position
  Value value;
  Location at;
};

// 'R'(1.0, 'y' = 2.0); missing fields have the value that the definition gives them.
Value construct_record(Elaboration& e, const syntax::Definition& definition, std::vector<Argument> arguments,
                       Location at);

}  // namespace sfdae::cli
