// How rows of [E A] are scaled (docs/design/scaling_and_units.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "problem/taylor_data.h"

namespace sfdae::core {

// A unit of time by which scaling rounds nothing.
double power_of_two_near(double x);
// What entries of A count beside those of E, tau: the unit of time of the problem.
double unit_of_A(RowScaling rows, double tau);
// From sizes of rows, their largest entries, to factors: powers of two that bring the largest row to [1, 2) and the
// others to once or twice that, as a common factor of all rows changes nothing but a common factor.
void become_row_factors(std::vector<double>& sizes, RowScaling rows);

}  // namespace sfdae::core
