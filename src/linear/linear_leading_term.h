// The leading term W x of a linear problem at a point, W = P, E or I, and its part in the differential equations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "linear/linear_point.h"

namespace sfdae::core {

// w := W x.
void apply_leading(LeadingTerm leading, const LinearPoint& point, const double* x, double* w, Arena& arena);

// q := Z1^T E w; E is in w already if W = E.
void differential_rows(LeadingTerm leading, const LinearPoint& point, const double* w, double* q, Arena& arena);
// A column of q for each of w.
void differential_rows(LeadingTerm leading, const LinearPoint& point, ConstView w, View q, Arena& arena);

// wdot += W' x, the part of (W x)' that does not come from x'.
void add_derivative_of_leading(const KnownForm& known, const LinearPoint& point, const double* x, double* wdot,
                               Arena& arena);

}  // namespace sfdae::core
