// Units of the unknowns in which a problem is analyzed first.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/coefficient_source.h"

namespace sfdae::core {

// E and A at t in the given units of the unknowns, which the source keeps, and of time (0: chosen). Throws Failure.
TaylorData data_in_units(CoefficientSource& source, double t, const Units& units, double time_scale = 0.0);

// Units of the user, but columns of [E A] that differ by more than 1024 become of comparable size, by powers of two
// (docs/design/scaling_and_units.md), and E and A in them. Throws Failure. The source is evaluated once, in units of
// one, which it keeps.
struct UsualUnits {
  Units units;
  TaylorData data;
};
UsualUnits usual_units(CoefficientSource& source, double t);

}  // namespace sfdae::core
