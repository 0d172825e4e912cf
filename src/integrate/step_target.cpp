// End of an attempted step.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/step_target.h"

#include <cmath>

namespace sfdae::core {

namespace {

// Remainder before a limit, relative to the step, that is a rounding error of the limit.
constexpr double rest_at_limit = 1e-10;
// Relative extension of a step that ends nearly at tout: the error test permits that much. (Chosen.)
constexpr double nearly = 1e-4;

}  // namespace

bool StepTarget::is_cut_short(double h) const { return std::fabs(uncut) > (1.0 + nearly) * std::fabs(h); }

StepTarget choose_target(const StepState& state, double size, const StepBounds& bounds) {
  const auto& [direction, tout, limit, never_pass_output] = bounds;
  const double h = direction * size;
  StepTarget target{state.t + h, 0.0};
  // Avoid tiny remainders before a limit; never pass it.
  if (limit && (target.t - *limit) * direction > -rest_at_limit * std::fabs(h)) target.t = *limit;
  // Steps that end at tout: near tout they are extended; a step cut short does not affect the size of the next one. If
  // interpolation would be inaccurate this is also the least expensive way, unless it makes steps shorter than
  // interpolation needs.
  const bool is_at_output =
      (target.t - tout) * direction > -nearly * std::fabs(h) && !(limit && (tout - *limit) * direction > 0.0);
  const bool is_too_long = std::fabs(target.t - state.t) > state.longest_interpolated;
  if (!is_at_output || !(never_pass_output || is_too_long)) return target;
  if (never_pass_output || std::fabs(tout - state.t) >= state.longest_interpolated) return {tout, h};
  return {state.t + direction * state.longest_interpolated, 0.0};
}

}  // namespace sfdae::core
