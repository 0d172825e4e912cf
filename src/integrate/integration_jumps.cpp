// Jumps of the solution where data jump, in the driver of the integration.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <utility>

#include "integrate/integration.h"
#include "integrate/jump_rule.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

// The point before stays the last one where that throws.
void Integration::cross_jump(const TimeBreakpoints::Gap& gap, double tout) {
  const double direction = integrator_.direction, t = gap.far_end(direction);
  if (companion_)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        format("sensitivities cannot be carried over the jump at t = %.15g: stop there (stop_time), and start "
               "anew with the directions that they have after it.",
               integrator_.stepper->state().t));
  const std::vector<double> before = integrator_.stepper->x();
  const double toward = (tout - t) * direction > 0.0 ? tout : time_beside(t, direction);
  const ConsistentPoint after = options_.jumps->values_after({t, toward, before.data()});
  resize_workspace();
  integrator_.start(t, after.x, after.xdot, options_);
  integrator_.must_restart = false;
  approach_.reset();
  if (watch_) watch_->start(direction);
  start_trail();
  record_jump(gap, after.x);
}

// Within the gap the values are those after it.
void Integration::record_jump(const TimeBreakpoints::Gap& gap, const std::vector<double>& after) {
  const std::shared_ptr<SolutionPieces> solution = solution_.lock();
  if (!solution || !is_recorded_) return;
  const auto sample = [&](double, double* x) {
    std::copy(after.begin(), after.end(), x);
    return true;
  };
  add_piece(*solution, {solution->end(), gap.far_end(integrator_.direction), true, sample, {}});
}

}  // namespace sfdae::core
