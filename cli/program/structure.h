// Structural analysis: the pattern of unknowns and derivatives in the equations, independent of numerical values.
//
// [P88] C. C. Pantelides: The consistent initialization of differential-algebraic systems. SIAM J. Sci. Stat. Comput.
//       9, 213-231, 1988.
// [P01] J. D. Pryce: A simple structural analysis method for DAEs. BIT 41, 364-394, 2001.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "model/flat_model.h"

namespace sfdae::cli {

// The structural index by [P88], which symbolic index reduction finds; the true index may be lower or, if numbers
// cancel, higher. None: the continuous equations cannot be matched with the continuous unknowns.
std::optional<int> structural_index(const FlatModel& model);

}  // namespace sfdae::cli
