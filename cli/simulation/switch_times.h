// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation/system.h"

namespace sfdae::cli {

// Finds switches whose argument is linear in time with coefficients that are constant between events, and switches that
// need a root function.
void find_switch_times(System& system);

}  // namespace sfdae::cli
