// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation/system.h"

namespace sfdae::cli {

// Finds switches whose argument is linear in time and constant otherwise, between events, and those that need a root
// function.
void find_switch_times(System& system);

}  // namespace sfdae::cli
