// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation/system.h"

namespace sfdae::cli {

// Sorts system.at_events.discrete so that variables are assigned before they are used, except in algebraic loops.
void sort_discrete(System& system);

}  // namespace sfdae::cli
