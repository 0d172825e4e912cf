// What the diagnostics report says of the structure of recorded equations that are solved by their minimal extension.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "expression/record.h"
#include "system/model.h"

namespace sfdae::core {

std::string structure_report(const Model::Extension& extension, const Record& record);

}  // namespace sfdae::core
