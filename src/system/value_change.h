// The largest change of values that were to stay as given: unknowns whose derivative occurs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/units.h"
#include "problem/taylor_data.h"

namespace sfdae::core {

struct ValueChange {
  int component = -1;  // i, -1: nothing changed
  double from = 0.0, to = 0.0;
  double in_tolerances = 0.0;  // |to - from| over the tolerance of x_i
  // Not x_i itself was to stay, but combinations of unknowns: to - from is its part in the change of these.
  bool is_part = false;

  bool is_beyond_tolerances() const { return in_tolerances > 1.0; }
};

// The largest of the changes (count of them, of components 0, ..., count - 1) from the values given, measured in the
// tolerances.
ValueChange largest_change(const double* given, const double* changes, const std::vector<double>& tolerances,
                           int count);

// Sets the flags of unknowns (n) with derivatives in the equations.
void mark_differentiated(const TaylorData& data, char* flags);
// A change dx of x measured by its effect on E x: the largest of |E_i dx| over |E_i| |tolerances|, E_i the rows of E.
// dx, tolerances: n values.
double differentiated_change(const TaylorData& data, const Units& units, const double* dx, const double* tolerances);

}  // namespace sfdae::core
