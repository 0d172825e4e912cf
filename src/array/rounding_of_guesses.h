// Rounding errors of linearizations at guesses, which say nothing about solutions
// (docs/design/error_control.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/quiet_arithmetic.h"
#include "system/jet.h"

namespace sfdae::core {

// Whether what error_of(j) says of the n unknowns at the point where the equations were linearized is far above the
// tolerances and what solutions are known to have: at a guess where exponentials are larger by orders of magnitude,
// for example. Every change is below that, and looks as if it had converged. Rounding errors at the point accepted
// last are true ones.
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
