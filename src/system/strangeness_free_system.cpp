// Interface of a problem for integrators: its strangeness-free system.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/strangeness_free_system.h"

#include <cmath>

namespace sfdae::core {

double cost_of_reduced_stages(int unknowns, int stage_size, int s) {
  // Cost of a reduction in n^3 operations (counted: 12 to 16 for an index up to 2).
  constexpr double reduction_cost = 15.0;
  // Common cost of the stages of one step apart from their reductions, in units of n^2. (Estimated.)
  constexpr double small_matrix_cost = 20.0;
  const double n = unknowns, q = stage_size, small_matrix = small_matrix_cost * n * n;
  return s * (reduction_cost * n * n * n + small_matrix) + 2.0 / 3.0 * std::pow(s * q, 3) + 2.0 * s * s * q * q * n;
}

}  // namespace sfdae::core
