// Kinks of inputs, and how steps cross them.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/kinks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Of a gap: a step of this size at most is one across it.
constexpr double about_a_gap = 1.5;
// Of the tolerances: what is differentiated jumps by more. Iterations leave less. (Chosen.)
constexpr double clear_jump = 10.0;

// Of what slopes on both sides of a gap explain: more is a jump. (Chosen.)
constexpr double clear_of_slopes = 2.0;

// Where t is large a gap is so wide that what changes fast changes by more than tolerances within it.
void leave_out_slopes(const Integrator& integrator, std::vector<double>& jump) {
  const std::size_t n = jump.size();
  const StepState state = integrator.stepper->state();
  std::vector<double> x(n), before(n), after(n, 0.0);
  integrator.stepper->interpolate({state.t, nullptr, x.data(), before.data()});
  integrator.system.exact_derivative(integrator.stepper->tried_x().data(), after.data());
  const double h = std::fabs(state.tried_t - state.t);
  for (std::size_t i = 0; i < n; ++i)
    if (std::fabs(jump[i]) <= clear_of_slopes * h * std::max(std::fabs(before[i]), std::fabs(after[i])))
      jump[i] = 0.0;
}

// Nothing is evaluated after the jump.
bool has_end_in(const IntegrationOptions& options, const TimeBreakpoints::Gap& gap, double direction) {
  return options.stop_time && (gap.far_end(direction) - *options.stop_time) * direction > 0.0;
}

}  // namespace

std::optional<double> next_kink(const IntegrationOptions& options, const StepFrom& step) {
  if (options.breakpoints == nullptr) return std::nullopt;
  const std::optional<double> kink = options.breakpoints->next(step.t, step.direction);
  // The end of the data, as the user's arithmetic has it.
  if (kink && std::fabs(step.tout - *kink) <= Integrator::resolution(step.t, step.tout)) return step.tout;
  return kink;
}

bool is_at_kink(const IntegrationOptions& options, const StepState& state) {
  if (options.breakpoints == nullptr || state.last.h == 0.0) return false;
  const auto gap = options.breakpoints->gap_at(state.t);
  return gap && gap->ends_at(state.t);
}

bool crosses_kink(const IntegrationOptions& options, double t, double h) {
  if (options.breakpoints == nullptr) return false;
  const auto gap = options.breakpoints->gap_at(t);
  return gap && std::fabs(h) <= about_a_gap * (gap->end - gap->start);
}

// What is asked of a kink itself is the solution after it, unless nothing is to be evaluated there. The end of the
// data, beyond which there is nothing to step to, may be a rounding error away.
double beside_kink(const IntegrationOptions& options, const Integrator& integrator, double t) {
  if (options.breakpoints == nullptr) return t;
  const double reached = integrator.stepper->state().t;
  if (std::fabs(t - reached) <= Integrator::resolution(reached, t)) return reached;
  const auto gap = options.breakpoints->gap_at(t);
  if (!gap || gap->ends_at(t)) return t;
  if (gap->is_jump && has_end_in(options, *gap, integrator.direction)) return gap->far_end(-integrator.direction);
  return options.stop_time && integrator.direction > 0.0 ? std::min(gap->end, *options.stop_time) : gap->end;
}

// Where t is large a gap is so wide that x changes within it.
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

std::optional<CallResult> obstacle_at_kink(const Integrator& integrator) {
  const std::vector<double>& before = integrator.stepper->x();
  const std::vector<double>& after = integrator.stepper->tried_x();
  const std::size_t n = index(integrator.system.unknowns());
  std::vector<double> jump(n), tolerances(n);
  for (std::size_t i = 0; i < n; ++i) {
    jump[i] = after[i] - before[i];
    tolerances[i] = integrator.weights.tolerance(static_cast<int>(i), after.data());
  }
  const auto find_change = [&] { return integrator.system.change_of_differentiated(jump.data(), tolerances.data()); };
  DifferentiatedChange change = find_change();
  if (!(change.size > clear_jump)) return std::nullopt;
  leave_out_slopes(integrator, jump);
  change = find_change();
  if (!(change.size > clear_jump)) return std::nullopt;
  return CallResult{
      SFDAE_STEP_TOO_SMALL,
      format("an input has a kink or a jump at t = %.15g that the equations differentiate too often: x[%d], whose "
             "derivative is in the equations, jumps by %.3g. Take a table of higher degree, make it a breakpoint at "
             "which x may "
             "jump (sfdae_set_breakpoints), or stop there and restart.",
             integrator.stepper->state().t, change.component, jump[index(change.component)])};
}

}  // namespace sfdae::core
