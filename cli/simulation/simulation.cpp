// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/simulation.h"

namespace sfdae::cli {

Result analyze(const FlatModel&, const Settings&) { return {}; }

Result solve(const FlatModel&, const Settings&) { return {}; }

}  // namespace sfdae::cli
