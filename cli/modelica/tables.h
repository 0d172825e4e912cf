// Tables of the standard library (ModelicaStandardTables) whose data are in the model, as piecewise formulas.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "modelica/built_in.h"

namespace sfdae::cli {

// An external object: the arguments of its constructor, by name.
Value construct_external_object(Elaboration& e, const syntax::Definition& object,
                                const std::vector<Argument>& arguments, Location at);

// The value of an external table function; none if the name is unknown. Breakpoints become events, so that no step
// crosses them.
std::optional<Value> call_table_function(Elaboration& e, const Environment& in, const Call& call);

}  // namespace sfdae::cli
