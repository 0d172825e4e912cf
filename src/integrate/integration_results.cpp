// Results of an integration that stops.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/integration_results.h"

#include <new>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

CallResult result_of_error_test(const Integrator& integrator) {
  const StepState state = integrator.stepper->state();
  const std::vector<double>& x = integrator.stepper->x();
  const int i = integrator.weights.worst(integrator.stepper->error().data());
  std::string message = format(
      "the error test fails at t = %.15g with the smallest step, %.3g; the error sits in "
      "x[%d] = %.6g.",
      state.t, state.next_step, i, x[index(i)]);
  if (integrator.weights.tolerance(i, x.data()) == 0.0) message += " Its tolerance is zero there: give it an atol.";
  else message += " The data may jump there, or the solution has a singularity: stop at such a point and restart.";
  return {SFDAE_STEP_TOO_SMALL, message};
}

}  // namespace

CallResult result_of_wrong_direction(double tout, double last_returned) {
  return {SFDAE_ILLEGAL_ARGUMENT, format("tout = %.15g lies before t = %.15g in the direction of integration. Use "
                                         "sfdae_start to change direction.",
                                         tout, last_returned)};
}

CallResult result_beyond_stop_time(double tout, double stop_time) {
  return {SFDAE_ILLEGAL_ARGUMENT, format("tout = %.15g lies beyond stop_time = %.15g.", tout, stop_time)};
}

CallResult result_outside_last_step(double t, double start, double end) {
  return {SFDAE_ILLEGAL_ARGUMENT,
          format("t = %.15g lies outside of the last step, from %.15g to %.15g.", t, start, end)};
}

// The event must be reported even if memory for the message is missing. Short strings need no allocation.
CallResult result_of_event(double t) noexcept {
  try {
    return {SFDAE_EVENT, format("event at t = %.15g: sfdae_get_events reports which. Advance again to go on.", t)};
  } catch (const std::bad_alloc&) {
    return {SFDAE_EVENT, "event."};
  }
}

CallResult result_of_stop_request(double t) {
  return {SFDAE_STOPPED, format("stopped on request at t = %.15g; the call can be repeated.", t)};
}

CallResult result_of_monitor_stop(double t) {
  return {SFDAE_STOPPED, format("stopped by the monitor at t = %.15g; the call can be repeated.", t)};
}

CallResult result_of_many_steps(long max_steps, double tout, double t) {
  return {SFDAE_MAX_STEPS, format("%ld steps attempted without reaching tout = %.15g; t = %.15g. Call again, raise "
                                  "max_steps, or loosen the tolerances.",
                                  max_steps, tout, t)};
}

CallResult result_of_small_tolerances(double t, double excess) {
  return {SFDAE_TOLERANCE_TOO_SMALL,
          format("the tolerances are too small for the precision of the machine at t = %.15g: multiply them by "
                 "%.2g at least.",
                 t, excess)};
}

CallResult result_of_ignored_contradictions(double largest) {
  return {
      SFDAE_INCONSISTENCY_IGNORED,
      format("redundant equations contradict each other (relative residual %.3g); ignored as asked for.", largest)};
}

CallResult result_of_change(const DaeSystem& system, const LocatedChange& change) {
  return {SFDAE_CHARACTERISTICS_CHANGED,
          "characteristic values changed from (" + describe(system.analysis().values) + ") to (" +
              describe(change.new_values) +
              format(") at t = %.12g. Call sfdae_analyze and sfdae_start after that point.", change.t) +
              system.about_change()};
}

void throw_jump_with_sensitivities(double t) {
  throw Failure(
      SFDAE_ILLEGAL_ARGUMENT,
      format("sensitivities cannot be carried over the jump at t = %.15g: stop there (stop_time), and start "
             "anew with the directions that they have after it.",
             t));
}

CallResult result_without_branches(double t) {
  return {SFDAE_ZENO, format("at t = %.15g steps fail, and branches of conditions may be the reason.", t)};
}

CallResult result_of_idle_steps(double t, double since) {
  return {SFDAE_STEP_TOO_SMALL, format("at t = %.15g x has not moved since t = %.15g, in many steps.", t, since)};
}

CallResult result_of_layers(double t) {
  return {SFDAE_ZENO,
          format("at t = %.15g x moves along a surface at which a condition switches, and this surface has "
                 "changed.",
                 t)};
}

CallResult result_of_smallest_step(StepOutcome outcome, const Integrator& integrator) {
  const double t = integrator.stepper->state().t;
  const CallbackError& callback_error = integrator.system.callback_error();
  switch (outcome) {
    case StepOutcome::callback_error:
      return {callback_error.status, callback_error.message() + " Smaller steps did not help."};
    case StepOutcome::singular:
      return {SFDAE_SINGULAR,
              format("the matrix of the step is singular beyond t = %.15g for every step size tried.", t)};
    case StepOutcome::not_converged:
      return {SFDAE_STEP_TOO_SMALL,
              format("the nonlinear equations of the step have no solution near the predicted one beyond t = %.15g, "
                     "however small the step. The solution may end or have a singularity there.",
                     t)};
    case StepOutcome::not_searched:
      return {
          SFDAE_STEP_TOO_SMALL,
          format("beyond t = %.15g it cannot be decided whether the characteristic values change, as the equations "
                 "cannot be evaluated between the points of a step, however short.",
                 t)};
    case StepOutcome::not_finite:
      return {SFDAE_STEP_TOO_SMALL, format("the solution overflows beyond t = %.15g.", t)};
    default: return result_of_error_test(integrator);
  }
}

}  // namespace sfdae::core
