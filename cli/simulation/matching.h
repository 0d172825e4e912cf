// Maximum matching of equations with the variables that they contain.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::cli {

// candidates[i]: variables 0 ... num_variables - 1 of equation i, the preferred one first. Returns the equation of each
// variable, -1 for none.
std::vector<int> matched_equations(const std::vector<std::vector<int>>& candidates, int num_variables);

}  // namespace sfdae::cli
