// Values of x after jumps of data.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/jump_rule.h"

#include <limits>
#include <vector>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

// Impulses are computed only if E x has to move. Otherwise they are zero, and it does not matter whether the equations
// determine them.
ConsistentPoint JumpRule::values(const PointOfInterest& before, DaeSystem& system, const Tolerance& tolerance,
                                 double none) {
  constexpr double little = 0.1;  // tolerances, if impulses are not determined. (Chosen.)
  if (!all_finite(before.x, index(system.unknowns())))
    throw Failure(SFDAE_NOT_FINITE, format("values before the jump at t = %.15g are not finite.", before.t));
  double moved = std::numeric_limits<double>::infinity();
  try {
    ConsistentPoint near = values_near(before);
    std::vector<double> change(near.x), tolerances(near.x.size());
    for (std::size_t i = 0; i < change.size(); ++i) {
      change[i] -= before.x[i];
      tolerances[i] = tolerance(static_cast<int>(i), near.x.data());
    }
    if (all_finite(change.data(), change.size()))
      moved = system.change_of_differentiated(change.data(), tolerances.data());
    if (moved <= none) return near;
  } catch (const Failure& failure) {
    if (failure.status() == SFDAE_CALLBACK_FAILED) throw;
  }
  try {
    return values_after(before);
  } catch (const Failure& failure) {
    if (!(moved <= little) || ends_everything(failure.status())) throw;
  }
  return values_near(before);
}

}  // namespace sfdae::core
