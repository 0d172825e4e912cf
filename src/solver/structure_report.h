// Structural analysis in the diagnostics report, for recorded equations solved by their minimal extension.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "expression/record.h"
#include "system/model.h"

namespace sfdae::core {

std::string structure_report(const Model::Extension& extension, const Record& record);

}  // namespace sfdae::core
