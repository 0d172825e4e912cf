// Derivatives of recorded equations by everything that they contain, recorded themselves. One forward pass evaluates
// them; backward sweeps for each equation take several times as long.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "expression/record.h"
#include "expression/tape.h"

namespace sfdae::core {

// Formulas of the entries of F_x and F_x' in the order of the targets of the tape, then those of F_p in the order of
// parameter_gradient(). Null if they have more than `most` nodes, as for equations that share many subexpressions.
std::shared_ptr<const Record> all_derivatives(const Record& record, const Tape& tape,
                                              const std::vector<int>& parameters, std::size_t most);

}  // namespace sfdae::core
