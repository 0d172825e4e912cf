// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation/system.h"

namespace sfdae::cli {

// Sorts system.at_events.discrete so that variables are assigned before they are used, as far as they do not depend on
// each other.
void sort_discrete(System& system);

}  // namespace sfdae::cli
