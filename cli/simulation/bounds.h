// Limits of variables and parameters.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulation/import.h"
#include "simulation/parameters.h"
#include "simulation/system.h"

namespace sfdae::cli {

// Adds min and max of the variable to system.checked. A value that is already known is checked at once.
void add_bounds(System& system, const Parameters& parameters, Import& import, int variable,
                std::vector<std::string>& warnings);

}  // namespace sfdae::cli
