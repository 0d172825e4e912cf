// Where an attempted step ends.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/step_target.h"

#include <cmath>

namespace sfdae::core {

namespace {

// Of a step: a rest before a limit that is a rounding error of the limit.
constexpr double rest_at_limit = 1e-10;
// Of a step: nearly at tout counts as there, as steps may be that much longer than what the error test allows.
// (Chosen.)
constexpr double nearly = 1e-4;

}  // namespace

bool StepTarget::is_cut_short(double h) const { return std::fabs(uncut) > (1.0 + nearly) * std::fabs(h); }

StepTarget choose_target(const StepState& state, double size, const StepBounds& bounds) {
  const auto& [direction, tout, limit, never_pass_output] = bounds;
  const double h = direction * size;
  StepTarget target{state.t + h, 0.0};
  // No tiny rest before a limit, and not a bit beyond.
  if (limit && (target.t - *limit) * direction > -rest_at_limit * std::fabs(h)) target.t = *limit;
  // Steps that end at tout: nearly there counts as there; the step cut short says nothing about the next one. Where
  // interpolation would not be accurate this is the cheapest way, too, unless it makes steps shorter than they need to
  // be for that.
  const bool is_at_output =
      (target.t - tout) * direction > -nearly * std::fabs(h) && !(limit && (tout - *limit) * direction > 0.0);
  const bool is_too_long = std::fabs(target.t - state.t) > state.longest_interpolated;
  if (!is_at_output || !(never_pass_output || is_too_long)) return target;
  if (never_pass_output || std::fabs(tout - state.t) >= state.longest_interpolated) return {tout, h};
  return {state.t + direction * state.longest_interpolated, 0.0};
}

}  // namespace sfdae::core
