// When clauses as formulas of discrete variables: v = e if a branch acts, else v = pre(v). Each condition is a virtual
// Boolean variable, whose pre() tells when it becomes true.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/import.h"
#include "simulation/system.h"

namespace sfdae::cli {

// Appends to system.at_events.discrete (in no particular order), system.reactions and system.at_events.when_conditions.
void import_whens(System& system, Import& import);

}  // namespace sfdae::cli
