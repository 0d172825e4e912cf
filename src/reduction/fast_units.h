// Units of the unknowns that fit a unit of time: for nonlinear problems (docs/design/scaling_and_units.md).
//
// A structure of fast and slow parts written in meters and seconds, q' = v, v' = w, M w + K q = f with K / M = 1e12,
// looks as if M were zero. In the fast unit of time, with the corresponding units of v and w, everything is of order
// one.
//
// [CR72] A. R. Curtis, J. K. Reid: On the automatic scaling of matrices for Gaussian elimination. IMA J. Appl. Math.
//        10 (1972) 118-124.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "problem/coefficient_source.h"

namespace sfdae::core {

// Powers of two, one for each unknown: in the equations that contain derivatives, the entries of E and tau A at t are
// as near to one as possible in the mean square of their logarithms [CR72]. Throws Failure. The column scale of the
// source is changed.
Units fast_units(CoefficientSource& source, double t, double tau);

}  // namespace sfdae::core
