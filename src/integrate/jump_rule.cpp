// Values of x after jumps of data.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/jump_rule.h"

#include <optional>
#include <utility>
#include <vector>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

// Impulses are computed only where E x has to move. Where it can stay, impulses have nothing to do, and it does not
// matter whether they are determined. Many changes that are passed over must not add up.
ConsistentPoint JumpRule::values(const PointOfInterest& before, DaeSystem& system, const Tolerance& tolerance,
                                 double none) {
  constexpr double little = 0.1;  // of the tolerances. (Chosen.)
  if (!all_finite(before.x, index(system.unknowns())))
    throw Failure(SFDAE_NOT_FINITE, format("values before the jump at t = %.15g are not finite.", before.t));
  std::optional<ConsistentPoint> near;
  try {
    near = values_near(before);
    std::vector<double> change(near->x), tolerances(near->x.size());
    for (std::size_t i = 0; i < change.size(); ++i) {
      change[i] -= before.x[i];
      tolerances[i] = tolerance(static_cast<int>(i), near->x.data());
    }
    const double moved = system.change_of_differentiated(change.data(), tolerances.data());
    if (all_finite(change.data(), change.size()) && moved <= none) return std::move(*near);
    if (!(moved <= little)) near.reset();
  } catch (const Failure& failure) {
    if (failure.status() == SFDAE_CALLBACK_FAILED) throw;
    near.reset();
  }
  if (!near) return values_after(before);
  try {
    return values_after(before);
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
  }
  return values_near(before);  // the system stands there
}

}  // namespace sfdae::core
