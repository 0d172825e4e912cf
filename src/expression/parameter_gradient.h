// Derivatives of recorded equations by their parameters, recorded themselves.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/record.h"

namespace sfdae::core {

// F_p of the parameters chosen (by their numbers), one below the other: formula i + j m is the derivative of equation i
// by the j-th of them. Parameters have the numbers that they have in the record.
std::shared_ptr<const Record> parameter_gradient(const Record& record, const std::vector<int>& parameters);

}  // namespace sfdae::core
