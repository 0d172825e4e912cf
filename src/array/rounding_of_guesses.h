// Rounding errors of linearizations at initial guesses, which do not describe solutions (docs/design/error_control.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/quiet_arithmetic.h"
#include "system/jet.h"

namespace sfdae::core {

// True if error_of(j), the rounding errors of the n unknowns at the point of the linearization, is far above the
// tolerances: at a guess where exponentials are larger by orders of magnitude, for example. Every change is below these
// errors, so that the iteration seems to have converged. Rounding errors at the last accepted point are genuine.
template <class ErrorOf>
bool is_drowned(const Jet& origin, const Jet& accepted, ErrorOf error_of, const double* inverse_weights) {
  constexpr double far_above = 10.0;
  if (origin.t == accepted.t && origin.x == accepted.x) return false;
  const QuietArithmetic quiet;
  for (int j = 0; j < accepted.n; ++j)
    if (!(error_of(j) * inverse_weights[j] <= far_above)) return true;
  return false;
}

}  // namespace sfdae::core
