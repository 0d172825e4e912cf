// Tables of the standard library (ModelicaStandardTables), whose data stands in the model, as piecewise formulas.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "modelica/built_in.h"

namespace sfdae::cli {

// An external object: what its constructor is called with, by name.
Value construct_external_object(Elaboration& e, const syntax::Definition& object,
                                const std::vector<Argument>& arguments, Location at);

// What an external function of that name gives; none: it is no function of tables that is known. Breakpoints make
// events, so that no step runs over them.
std::optional<Value> call_table_function(Elaboration& e, const Environment& in, const Call& call);

}  // namespace sfdae::cli
