// A number that tells recorded equations apart.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "expression/record.h"
#include "linalg/archive.h"

namespace sfdae::core {

// Adds all that the equations consist of: operations and operands, numbers, functions with the data of tables, names of
// parameters (not their values) and the order of the equations. Functions that users supply count by name and number of
// arguments: nothing else of them is known. The same recording gives the same hash in every process.
void add_equations(const Record& record, WordHash& hash);

}  // namespace sfdae::core
