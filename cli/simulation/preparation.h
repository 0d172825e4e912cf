// Prepares a flat model for the solution: import, classification, reduction.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "simulation/parameters.h"
#include "simulation/system.h"

namespace sfdae::cli {

// Throws ModelError. The model must outlive the system. reduce_above: as in Settings.
std::unique_ptr<System> prepared(const FlatModel& model, Parameters& parameters, std::vector<std::string>& warnings,
                                 int reduce_above);

}  // namespace sfdae::cli
