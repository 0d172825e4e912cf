// Row scaling of [E A] (docs/design/scaling_and_units.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "problem/taylor_data.h"

namespace sfdae::core {

// Unit of time that scales without rounding errors.
double power_of_two_near(double x);
// Weight of entries of A relative to those of E. tau: the unit of time of the problem.
double unit_of_A(RowScaling rows, double tau);
// Converts sizes of rows, their largest entries, to factors: powers of two that bring the largest row to [1, 2) and the
// others to once or twice that, as a common factor of all rows has no effect.
void become_row_factors(std::vector<double>& sizes, RowScaling rows);

}  // namespace sfdae::core
