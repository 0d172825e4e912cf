// Points within the last step.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/step_output.h"

#include <algorithm>
#include <optional>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Evaluates again if the user's function failed for reasons that may be temporary: there is no other point to try.
template <class Evaluate>
PointStatus evaluate_or_raise(DaeSystem& system, Evaluate evaluate) {
  PointStatus status = evaluate();
  if (status == PointStatus::callback_error && system.callback_error().is_recoverable()) status = evaluate();
  if (status == PointStatus::callback_error) system.callback_error().raise();
  return status;
}

// Moves the system to t, or throws Failure.
template <class Move>
void demand_point(DaeSystem& system, double t, Move move) {
  const PointStatus status = evaluate_or_raise(system, move);
  if (status == PointStatus::changed)
    throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                  format("the characteristic values do not hold at t = %.15g, an isolated point: choose another "
                         "output time.",
                         t));
  if (status != PointStatus::ok)
    throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                  format("the solution could not be evaluated at t = %.15g: the polynomial of the last step is not "
                         "accurate enough there, and the equations of a step that ends there have no solution.",
                         t));
}

void check_ranks(Integrator& integrator, double t) {
  DaeSystem& system = integrator.system;
  const PointStatus status = evaluate_or_raise(system, [&] { return system.check_ranks(); });
  if (status == PointStatus::ok) return;
  if (status != PointStatus::changed)
    throw Failure(SFDAE_RANK_UNCLEAR,
                  format("it could not be checked whether the characteristic values known hold at t = %.15g.", t));
  const StepState state = integrator.stepper->state();
  throw Failure(
      SFDAE_CHARACTERISTICS_CHANGED,
      format("the characteristic values known do not hold at t = %.15g any more: they have changed since t = "
             "%.15g or before. Analyze the problem after the change.",
             t, state.t - state.last.h));
}

void check_differences(Integrator& integrator, const double* x) {
  const auto excess = integrator.differences.excess_at(integrator.system, integrator.weights, x);
  if (excess) throw Failure(excess->status, excess->message);
}

// xdot: the slope of the polynomial (docs/design/bdf.md).
void find_slopes(Integrator& integrator, const PointRequest& request, double* x, double* xdot) {
  DaeSystem& system = integrator.system;
  const StepState state = integrator.stepper->state();
  // The slope of a polynomial of high degree over a long step is less accurate than x.
  const bool is_within_long_step =
      integrator.method == Method::radau && request.t != state.t && request.slopes == Slopes::wanted;
  if (request.slopes == Slopes::none || (request.slopes == Slopes::rough && !system.is_linear()))
    std::fill_n(xdot, system.unknowns(), 0.0);
  else if (system.differential() == 0 || request.slopes == Slopes::consistent)
    system.consistent_derivative(x, integrator.direction, xdot);
  else if (!(is_within_long_step && system.exact_derivative(x, xdot)))
    system.correct_derivative(state.last.leading_coefficient, x, xdot);
  const std::size_t n = index(system.unknowns());
  if (!all_finite(xdot, n)) system.consistent_derivative(x, integrator.direction, xdot);
  if (!all_finite(x, n) || !all_finite(xdot, n))
    throw Failure(SFDAE_NOT_FINITE, format("the solution or its derivative overflows at t = %.15g.", request.t));
}

}  // namespace

void StepOutput::resize(const DaeSystem& system) {
  w_.resize(std::max(w_.size(), index(system.leading_size())));
  x_free_.resize(index(system.unknowns()));
}

void StepOutput::interpolate(Stepper& stepper, double t, double* x, double* xdot) {
  stepper.interpolate({t, nullptr, x, xdot});
}

void StepOutput::refine(Integrator& integrator, double t, double* x, double* xdot) {
  const PointValues point{t, w_.data(), x, xdot};
  integrator.stepper->interpolate(point);
  demand_point(integrator.system, t,
               [&] { return integrator.stepper->refine(integrator.system, integrator.weights, point); });
}

void StepOutput::evaluate(Integrator& integrator, const PointRequest& request, const IntegrationOptions& options,
                          double* x, double* xdot) {
  if (request.may_interpolate && has_interpolated(integrator, request, options, x, xdot)) return;
  find_values(integrator, request, options, x, xdot);
  const bool is_within = request.t != integrator.stepper->state().t;
  // Polynomials of nonlinear problems are never rejected.
  if (is_within && request.may_refine && integrator.system.is_linear() &&
      integrator.stepper->gives_up_polynomial(integrator.weights, x_free_.data(), x))
    find_values(integrator, request, options, x, xdot);
  check_ranks(integrator, request.t);
  check_differences(integrator, x);
  find_slopes(integrator, request, x, xdot);
  if (request.distance == 0.0) return;
  for (std::size_t i = 0; i < index(integrator.system.unknowns()); ++i) x[i] += request.distance * xdot[i];
}

// Consistent x, and the slope of the polynomial if requested.
void StepOutput::find_values(Integrator& integrator, const PointRequest& request, const IntegrationOptions& options,
                             double* x, double* xdot) {
  DaeSystem& system = integrator.system;
  // Nonlinear problems are restored from x, which determines w.
  double* const w = system.is_linear() ? w_.data() : nullptr;
  const PointValues point{request.t, w, x_free_.data(), request.slopes == Slopes::none ? nullptr : xdot};
  integrator.stepper->interpolate(point);
  move_to(integrator, request, point);
  if (!integrator.contradictions.tolerate(system.quality().inconsistency, options))
    throw Failure(SFDAE_INCONSISTENT_EQUATIONS, system.inconsistency_message());
  restore(integrator, request.t, x);
}

void StepOutput::evaluate_aside(Integrator& integrator, const PointRequest& request,
                                const IntegrationOptions& options, double* x, double* xdot) {
  x_.resize(x_free_.size());
  evaluate(integrator, request, options, x_.data(), unused_slopes());
  std::copy(x_.begin(), x_.end(), x);
  if (xdot != nullptr) std::copy(slopes_.begin(), slopes_.end(), xdot);
}

// The end of a step has passed the error test, whatever the accuracy within the step.
bool StepOutput::has_interpolated(Integrator& integrator, const PointRequest& request,
                                  const IntegrationOptions& options, double* x, double* xdot) {
  Stepper& stepper = *integrator.stepper;
  // A consistent point shows errors of finite differences there; if these are too large the call ends.
  if (integrator.differences.is_in_doubt(integrator.weights)) return false;
  // Without differential equations no error test covers the slopes.
  if (integrator.system.differential() == 0 && request.slopes != Slopes::none) return false;
  const bool at_step = request.t == stepper.state().t;
  if (!at_step && !integrator.must_restart) test_polynomial(integrator, options, x, xdot);
  if (integrator.must_restart || !(at_step || stepper.interpolates_x(integrator.weights))) return false;
  const std::size_t n = index(integrator.system.unknowns());
  if (request.slopes == Slopes::none) {
    stepper.interpolate({request.t, nullptr, x, nullptr});
    std::fill_n(xdot, n, 0.0);
    return all_finite(x, n);
  }
  stepper.interpolate({request.t, nullptr, x, xdot});
  return all_finite(x, n) && all_finite(xdot, n);
}

// May overwrite x and xdot. If the test fails with an error, the polynomial remains untested.
void StepOutput::test_polynomial(Integrator& integrator, const IntegrationOptions& options, double* x, double* xdot) {
  const std::optional<double> t = integrator.stepper->point_of_test();
  if (!t) return;
  try {
    find_values(integrator, {*t, true, Slopes::none}, options, x, xdot);
    integrator.stepper->gives_up_polynomial(integrator.weights, x_free_.data(), x);
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
  }
}

void StepOutput::move_to(Integrator& integrator, const PointRequest& request, const PointValues& point) {
  DaeSystem& system = integrator.system;
  const bool at_step = request.t == integrator.stepper->state().t;
  if (at_step && system.t() == request.t) return;
  const auto move = [&] {
    return at_step || !request.may_refine ? system.move_to(request.t)
                                          : integrator.stepper->refine(system, integrator.weights, point);
  };
  demand_point(system, request.t, move);
}

// x that fulfills the constraints, from the values of the polynomials.
void StepOutput::restore(Integrator& integrator, double t, double* x) {
  DaeSystem& system = integrator.system;
  const std::vector<double>& x_last = integrator.stepper->x();
  const bool at_step = t == integrator.stepper->state().t;
  if (integrator.must_restart && !at_step) {
    // The history has another leading term: only x can be used.
    w_.resize(std::max(w_.size(), index(system.leading_size())));
    system.leading(x_free_.data(), w_.data());
  }
  // Iterations for nonlinear equations stop at errors below the tolerances: the constraints require more accuracy.
  if (at_step && system.is_linear()) {
    std::copy(x_last.begin(), x_last.end(), x);
    return;
  }
  Guess guess;
  if (!at_step && system.taylor_order() > 0) guess = integrator.stepper->guess_within(t, system.taylor_order());
  guess.inverse_weights = integrator.weights.inverse();
  system.restore(w_.data(), at_step ? x_last.data() : x_free_.data(), guess, x);
}

void StepOutput::last_point(Stepper& stepper, double& t, double* x, double* xdot) {
  t = stepper.state().t;
  std::copy(stepper.x().begin(), stepper.x().end(), x);
  stepper.interpolate({t, nullptr, x_free_.data(), xdot});
}

void StepOutput::make_consistent(Integrator& integrator, Slopes slopes, double* x, double* xdot) {
  DaeSystem& system = integrator.system;
  const std::vector<double>& x_last = integrator.stepper->x();
  const StepState state = integrator.stepper->state();
  try {
    if (system.move_to(state.t) != PointStatus::ok) return;
    system.restore(nullptr, x_last.data(), x);
    if (slopes == Slopes::wanted) system.correct_derivative(state.last.leading_coefficient, x, xdot);
  } catch (const Failure&) {
    std::copy(x_last.begin(), x_last.end(), x);
  }
}

}  // namespace sfdae::core
