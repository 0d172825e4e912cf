// Kinks of inputs, and steps across them.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/kinks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "integrate/jump_rule.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Maximum size of a step across a gap, relative to the gap.
constexpr double about_a_gap = 1.5;
// In tolerances: E x has to move if it jumps by more. Errors of iterations are smaller. (Chosen.)
constexpr double large_jump = 10.0;

// A jump is larger than so many times the change that slopes at both ends explain. (Chosen.)
constexpr double clear_of_slopes = 2.0;

// True if the stop time prevents evaluations after the jump.
bool has_end_in(const IntegrationOptions& options, const TimeBreakpoints::Gap& gap, double direction) {
  return options.stop_time && (gap.far_end(direction) - *options.stop_time) * direction > 0.0;
}

}  // namespace

std::optional<double> next_kink(const IntegrationOptions& options, const StepFrom& step, double longest) {
  if (options.breakpoints == nullptr) return std::nullopt;
  const auto kink = options.breakpoints->next(step.t, step.t + step.direction * longest);
  if (!kink) return std::nullopt;
  if (kink->t == step.t)
    throw Failure(SFDAE_STEP_TOO_SMALL,
                  format("from t = %.15g on rounding errors alone decide about a condition on t, or about what is "
                         "rounded down or up: write it so that it is not next to its border all the time.",
                         step.t));
  // The end of the data, within the rounding errors of the user.
  const double same = std::max(kink->slack, Integrator::resolution(step.t, step.tout));
  return std::fabs(step.tout - kink->t) <= same ? step.tout : kink->t;
}

bool is_at_kink(const IntegrationOptions& options, const StepState& state) {
  if (options.breakpoints == nullptr || state.last.h == 0.0) return false;
  const auto gap = options.breakpoints->gap_at(state.t);
  return gap && gap->ends_at(state.t);
}

bool crosses_kink(const IntegrationOptions& options, double t, double h) {
  if (options.breakpoints == nullptr) return false;
  const auto gap = options.breakpoints->gap_at(t);
  return gap && std::fabs(h) <= about_a_gap * (gap->end - gap->start) && (gap->far_end(h) - t) * h > 0.0;
}

// The solution at a kink is the one after it, unless evaluations there are not allowed. The end of the data, which
// steps cannot pass, may differ by a rounding error.
double beside_kink(const IntegrationOptions& options, const Integrator& integrator, double t) {
  if (options.breakpoints == nullptr) return t;
  const double reached = integrator.stepper->state().t;
  if (std::fabs(t - reached) <= Integrator::resolution(reached, t)) return reached;
  const auto gap = options.breakpoints->gap_at(t);
  if (!gap) return options.breakpoints->are_one(reached, t) ? reached : t;
  if (gap->ends_at(t)) return t - gap->start < gap->end - t ? gap->start : gap->end;
  if (gap->is_jump && has_end_in(options, *gap, integrator.direction)) return gap->far_end(-integrator.direction);
  return options.stop_time && integrator.direction > 0.0 ? std::min(gap->end, *options.stop_time) : gap->end;
}

// Gaps near large times are so wide that x changes within them.
PointRequest request_beside_kink(double t, const PointRequest& request) {
  const double distance = t - request.t;
  if (std::fabs(distance) <= Integrator::resolution(t, request.t)) return request;
  return {request.t, request.may_refine, Slopes::consistent, false, distance};
}

std::optional<TimeBreakpoints::Gap> jump_at(const IntegrationOptions& options, double t, double direction) {
  if (options.breakpoints == nullptr || options.jumps == nullptr) return std::nullopt;
  const auto gap = options.breakpoints->gap_at(t);
  return gap && gap->is_jump && gap->begins_at(t, direction) && !has_end_in(options, *gap, direction) ? gap
                                                                                                      : std::nullopt;
}

void keep_to_piece(const IntegrationOptions& options, DaeSystem& system, const StepFrom& step, double start) {
  if (options.breakpoints == nullptr || !options.breakpoints->has_times()) return;
  const double direction = step.direction;
  const auto gap = options.breakpoints->gap_at(step.t);
  // A step across a gap belongs to the piece after it.
  double from = gap ? gap->far_end(direction) : options.breakpoints->end_of_piece(step.t, -direction);
  double to = options.breakpoints->end_of_piece(step.t, direction);
  if ((start - from) * direction > 0.0) from = start;
  if (options.stop_time && (to - *options.stop_time) * direction > 0.0) to = *options.stop_time;
  system.set_limits(std::min(from, to), std::max(from, to));
}

bool JumpTest::has_jump(const Integrator& integrator, bool only_large) {
  if (!integrator.system.differentiates()) return false;  // E x is continuous
  const StepState state = integrator.stepper->state();
  const std::vector<double>& after = integrator.stepper->tried_x();
  for (std::size_t i = 0; i < jump_.size(); ++i) {
    jump_[i] = after[i] - integrator.stepper->x()[i];
    tolerances_[i] = integrator.weights.tolerance(static_cast<int>(i), after.data());
  }
  if (!is_clear(integrator, only_large)) return false;
  integrator.stepper->interpolate({state.t, nullptr, x_.data(), slopes_.data()});
  leave_out(state.tried_t - state.t);
  if (integrator.system.exact_derivative(after.data(), slopes_.data())) leave_out(state.tried_t - state.t);
  return is_clear(integrator, only_large);
}

bool JumpTest::is_clear(const Integrator& integrator, bool only_large) const {
  const double least = only_large ? large_jump : negligible_jump;
  return integrator.system.change_of_differentiated(jump_.data(), tolerances_.data()) > least;
}

// Gaps near large times are so wide that fast components change by more than their tolerances within them.
void JumpTest::leave_out(double h) {
  for (std::size_t i = 0; i < jump_.size(); ++i)
    if (std::isfinite(slopes_[i]) && std::fabs(jump_[i]) <= clear_of_slopes * std::fabs(h * slopes_[i]))
      jump_[i] = 0.0;
}

}  // namespace sfdae::core
