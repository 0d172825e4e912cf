// States of the minimal extension, block by block of the system Jacobian.
//
// The equations f_i^(c_i + k) of stage k < 0 contain x_j^(d_j + k) with the entries of the system Jacobian, up to
// factors of rows and columns. In a nonsingular block they leave over some of its unknowns, whatever the sizes of other
// derivatives are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "extension/minimal_extension.h"
#include "system/jet.h"

namespace sfdae::core {

// Ascending. No result if a block is singular near the jet, if something else than x_j would be left over, or if the
// equations cannot be evaluated.
std::optional<std::vector<int>> states_by_blocks(MinimalExtension& extension, const Jet& jet);

}  // namespace sfdae::core
