// The same recorded equations with some of their parameters as further unknowns: derivatives by parameters are then
// derivatives by unknowns.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/record.h"

namespace sfdae::core {

// Parameter parameters[k] is unknown n + k. All parameters keep their numbers.
std::shared_ptr<const Record> with_parameters_as_unknowns(const Record& record, const std::vector<int>& parameters);

}  // namespace sfdae::core
