// Kinks of inputs, and how steps cross them.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/kinks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "expression/time_breakpoints.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Of a gap: a step of this size at most is one across it.
constexpr double about_a_gap = 1.5;
// Of the tolerances: what is differentiated jumps by more. Iterations leave less. (Chosen.)
constexpr double clear_jump = 10.0;

}  // namespace

std::optional<double> next_kink(const IntegrationOptions& options, const StepFrom& step) {
  if (options.breakpoints == nullptr) return std::nullopt;
  const std::optional<double> kink = options.breakpoints->next(step.t, step.direction);
  // The end of the data, as the user's arithmetic has it.
  if (kink && std::fabs(step.tout - *kink) <= Integrator::smallest_step(step.t, step.tout)) return step.tout;
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

// What is asked of a kink itself is the solution after it, unless nothing is to be evaluated there. The end of the data,
// beyond which there is nothing to step to, may be a rounding error away.
double beside_kink(const IntegrationOptions& options, const Integrator& integrator, double t) {
  if (options.breakpoints == nullptr) return t;
  const double reached = integrator.stepper->state().t;
  if (std::fabs(t - reached) <= Integrator::smallest_step(reached, t)) return reached;
  const auto gap = options.breakpoints->gap_at(t);
  if (!gap || gap->ends_at(t)) return t;
  return options.stop_time && integrator.direction > 0.0 ? std::min(gap->end, *options.stop_time) : gap->end;
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
  const DifferentiatedChange change = integrator.system.change_of_differentiated(jump.data(), tolerances.data());
  if (!(change.size > clear_jump)) return std::nullopt;
  return CallResult{
      SFDAE_STEP_TOO_SMALL,
      format(
          "an input has a kink or a jump at t = %.15g that the equations differentiate too often: x[%d], whose "
          "derivative is in the equations, jumps by %.3g. Take a table of higher degree, or stop there and restart.",
          integrator.stepper->state().t, change.component, jump[index(change.component)])};
}

}  // namespace sfdae::core
