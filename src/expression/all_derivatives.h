// Derivatives of recorded equations by all that they contain, recorded themselves: one forward pass evaluates them,
// where sweeps backward for each equation take several times as long.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "expression/record.h"
#include "expression/tape.h"

namespace sfdae::core {

// Formulas of the entries of F_x and F_x' in the order of the targets of the tape, then those of F_p as
// parameter_gradient() has them. Null: they have more than `most` nodes, as where equations share much of what they
// are made of.
std::shared_ptr<const Record> all_derivatives(const Record& record, const Tape& tape,
                                              const std::vector<int>& parameters, std::size_t most);

}  // namespace sfdae::core
