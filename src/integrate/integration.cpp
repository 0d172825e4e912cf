// The driver of the integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/integration.h"

#include <algorithm>
#include <cmath>

#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Attempts in a row that fail for want of a valid point before the call gives up.
constexpr int max_point_failures = 12;
// The first attempt in units of the interval, at most: no simple fraction, which might be a period of the data.
constexpr double first_step_fraction = 0.7390851e-3;

CallResult failure_result(const Failure& failure) { return {failure.status(), failure.what()}; }

}  // namespace

Integration::Integration(LinearSystem& system, const IntegrationOptions& options, double t, double toward,
                         const Vector& x, const Vector& xdot)
    : system_(system),
      direction_(toward < t ? -1.0 : 1.0),
      last_returned_(t),
      reductions_before_(system.reductions()),
      factorizations_before_(system.factorizations()) {
  set_options(options);
  // The first attempt measures the error of order 1, and its size is corrected from that: a change of x by about the
  // square root of the tolerance has an error of about the tolerance.
  first_step_ = std::min(first_step_fraction * std::fabs(toward - t), weights_.first_step(x.data(), xdot.data()));
  begin(t, x, xdot);
  watch_.start(system_, direction_);
}

void Integration::set_options(const IntegrationOptions& options) {
  options_ = options;
  weights_.set(options_.tolerances);
  bdf_.set_max_order(options_.max_order);
}

IntegrationCounts Integration::counts() const {
  IntegrationCounts counts = counts_;
  counts.reductions = system_.reductions() - reductions_before_;
  counts.factorizations = system_.factorizations() - factorizations_before_;
  return counts;
}

void Integration::begin(double t, const Vector& x, const Vector& xdot) {
  const double h = direction_ * (options_.initial_step > 0.0 ? options_.initial_step : first_step_);
  const std::size_t size = static_cast<std::size_t>(system_.leading_size());
  Vector w(size), wdot(size);
  system_.leading(x.data(), w.data());
  system_.leading_derivative(x.data(), xdot.data(), wdot.data());
  bdf_.start(system_, t, x, xdot, w, wdot, h, options_.max_order);
  system_.accept();
  scratch_w_.resize(size);
  scratch_x_.resize(x.size());
}

CallResult Integration::advance(double tout, bool one_step, double& t, double* x, double* xdot) {
  if ((tout - last_returned_) * direction_ < 0.0)
    return {SFDAE_ILLEGAL_ARGUMENT, format("tout = %.15g lies behind t = %.15g in the direction of integration. Use "
                                           "sfdae_start to change direction.",
                                           tout, last_returned_)};
  if (options_.stop_time && (*options_.stop_time - tout) * direction_ < 0.0)
    return {SFDAE_ILLEGAL_ARGUMENT,
            format("tout = %.15g lies beyond stop_time = %.15g.", tout, *options_.stop_time)};
  inconsistent_ = false;
  CallResult result;
  try {
    result = run(tout, one_step);
    if (result.status == SFDAE_OK) result = output(tout, t, x, xdot);
    else return_last_point(t, x, xdot);
  } catch (const Failure& failure) {
    return_last_point(t, x, xdot);
    result = failure_result(failure);
  } catch (...) {
    return_last_point(t, x, xdot);
    throw;
  }
  if (result.status == SFDAE_STOPPED) system_.problem().take_stop_request();
  if (result.status == SFDAE_OK && inconsistent_)
    result = {SFDAE_INCONSISTENCY_IGNORED,
              format("redundant equations contradict each other (relative residual %.3g); ignored as asked for.",
                     counts_.inconsistency)};
  // A call that was stopped may be repeated with the same tout, even if the last step went past it.
  last_returned_ = (t - tout) * direction_ > 0.0 ? tout : t;
  return result;
}

void Integration::restart_at_last_point() {
  const double t = bdf_.t();
  if (system_.move_to(t) == PointStatus::trouble) throw Failure(system_.trouble().status, system_.trouble().message());
  const Vector x = bdf_.x();
  Vector xdot(x.size());
  system_.consistent_derivative(x.data(), direction_, xdot.data());
  begin(t, x, xdot);
  must_restart_ = false;
}

CallResult Integration::run(double tout, bool one_step) {
  // The last call gave up with a step that tells nothing about the solution.
  if (must_restart_ && !change_ && !has_passed(tout)) restart_at_last_point();
  for (long attempts = 0; !has_passed(tout); ++attempts) {
    if (system_.problem().stop_is_requested())
      return {SFDAE_STOPPED, format("stopped on request at t = %.15g; the call can be repeated.", bdf_.t())};
    if (change_ && has_passed(change_->t_before)) return changed_result();
    if (attempts >= options_.max_steps)
      return {SFDAE_MAX_STEPS, format("%ld steps attempted without reaching tout = %.15g; t = %.15g. Call again, raise "
                                      "max_steps, or loosen the tolerances.",
                                      options_.max_steps, tout, bdf_.t())};
    if (weights_.rounding(bdf_.x().data()) > 1.0)
      return {SFDAE_TOLERANCE_TOO_SMALL,
              format("the tolerances are too small for the precision of the machine at t = %.15g: multiply them by "
                     "%.2g at least.",
                     bdf_.t(), weights_.rounding(bdf_.x().data()))};
    const long steps = counts_.steps;
    if (auto result = attempt_step(tout)) return *result;
    if (one_step && counts_.steps > steps && !has_passed(tout)) return {SFDAE_STEP_TAKEN, ""};
  }
  return {};
}

double Integration::smallest_step(double tout) const {
  return 4.0 * 2.0 * unit_roundoff * std::max(std::fabs(bdf_.t()), std::fabs(tout));
}

std::optional<double> Integration::limit() const {
  if (change_) return change_->t_before;
  return options_.stop_time;
}

double Integration::choose_step(double tout) const {
  const double t = bdf_.t();
  double h = std::fabs(bdf_.next_step());
  // Without differential equations nothing accumulates: the solution at tout is one reduction away.
  if (system_.differential() == 0 && bdf_.failures_in_a_row() == 0) h = std::fabs(tout - t);
  if (options_.max_step > 0.0) h = std::min(h, options_.max_step);
  return direction_ * h;
}

std::optional<CallResult> Integration::attempt_step(double tout) {
  double h = choose_step(tout);
  const double t = bdf_.t();
  if (std::fabs(h) < smallest_step(tout)) {
    if (bdf_.failures_in_a_row() > 0) return step_too_small(StepOutcome::error_too_large);
    h = direction_ * smallest_step(tout);
  }
  // No tiny rest before a limit, and not a bit beyond.
  double target = t + h;
  if (const auto end = limit(); end && (target - *end) * direction_ > -1e-10 * std::fabs(h)) target = *end;
  h = target - t;
  const StepOutcome outcome = bdf_.attempt(system_, target, weights_);
  if (outcome == StepOutcome::accepted) return accept_step(h);
  return handle_failure(outcome, h, tout);
}

std::optional<CallResult> Integration::accept_step(double h) {
  const double inconsistency = system_.inconsistency();
  if (inconsistency > options_.consistency_tol) {
    if (!options_.ignore_inconsistency) {
      bdf_.withdraw();
      return CallResult{SFDAE_INCONSISTENT_EQUATIONS, system_.inconsistency_message()};
    }
    inconsistent_ = true;
  }
  counts_.inconsistency = std::max(counts_.inconsistency, inconsistency);
  if (!change_ && watch_.is_suspicious(system_)) {
    const double left = bdf_.t(), right = bdf_.tried_t();
    change_ = ChangeWatch::locate(system_, left, right, false);
    if (change_) {
      bdf_.withdraw();
      bdf_.set_next_step(h);
      return std::nullopt;
    }
  }
  watch_.accept(system_);
  counts_.smallest_kept = std::min({counts_.smallest_kept, system_.smallest_pivot(), system_.kept_constraints(),
                                    system_.kept_differential()});
  bdf_.commit();
  system_.accept();
  if (counts_.steps++ == 0) counts_.first_step = h;
  if (options_.monitor != nullptr) {
    const sfdae_progress progress{sizeof(sfdae_progress), bdf_.t(), h, bdf_.order(), counts_.steps,
                                  system_.unknowns(), bdf_.x().data()};
    if (options_.monitor(&progress, options_.monitor_user) != 0)
      return CallResult{SFDAE_STOPPED, format("stopped by the monitor at t = %.15g; the call can be repeated.", bdf_.t())};
  }
  return std::nullopt;
}

std::optional<CallResult> Integration::handle_failure(StepOutcome outcome, double h, double tout) {
  switch (outcome) {
    case StepOutcome::error_too_large:
      ++counts_.error_failures;
      return std::nullopt;
    case StepOutcome::trouble:
      if (!system_.trouble().is_recoverable())
        return CallResult{system_.trouble().status, system_.trouble().message()};
      break;
    case StepOutcome::leading_changed: {
      // rank E is not constant, though the hypothesis holds: w = P x has no continuous meaning, w = E x has.
      must_restart_ = true;
      system_.give_up_projector();
      restart_at_last_point();
      ++counts_.other_failures;
      return std::nullopt;
    }
    case StepOutcome::changed:
      if (std::fabs(h) > smallest_step(tout) * 64.0) {
        change_ = ChangeWatch::locate(system_, bdf_.t(), bdf_.tried_t(), true);
        if (change_) {
          bdf_.withdraw();
          return std::nullopt;
        }
      } else {
        change_ = LocatedChange{bdf_.t(), bdf_.tried_t(),
                                find_local_values(system_.problem(), bdf_.tried_t(), system_.settings(), system_.arena())};
        return std::nullopt;
      }
      break;
    default:
      break;
  }
  ++counts_.other_failures;
  bdf_.reduce_after_failure(h);
  if (bdf_.failures_in_a_row() > max_point_failures || std::fabs(bdf_.next_step()) < smallest_step(tout))
    return step_too_small(outcome);
  return std::nullopt;
}

CallResult Integration::step_too_small(StepOutcome outcome) {
  if (change_) return changed_result();
  must_restart_ = true;
  const double t = bdf_.t();
  if (outcome == StepOutcome::trouble)
    return {system_.trouble().status, system_.trouble().message() + " Smaller steps did not help."};
  if (outcome == StepOutcome::singular)
    return {SFDAE_SINGULAR, format("the matrix of the step is singular beyond t = %.15g for every step size tried.", t)};
  if (outcome == StepOutcome::not_finite)
    return {SFDAE_STEP_TOO_SMALL, format("the solution overflows beyond t = %.15g.", t)};
  const int i = weights_.worst(bdf_.error().data());
  std::string message = format("the error test fails at t = %.15g with the smallest step, %.3g; the error sits in "
                               "x[%d] = %.6g.",
                               t, bdf_.next_step(), i, bdf_.x()[static_cast<std::size_t>(i)]);
  if (weights_.tolerance(i, bdf_.x().data()) == 0.0) message += " Its tolerance is zero there: give it an atol.";
  else message += " The data may jump there, or the solution has a singularity: stop at such a point and restart.";
  return {SFDAE_STEP_TOO_SMALL, message};
}

CallResult Integration::changed_result() const {
  return {SFDAE_CHARACTERISTICS_CHANGED,
          "characteristic values changed from (" + describe(system_.analysis().values) + ") to (" +
              describe(change_->new_values) +
              format(") at t = %.12g. Call sfdae_analyze and sfdae_start behind that point.", change_->t)};
}

void Integration::return_last_point(double& t, double* x, double* xdot) {
  t = bdf_.t();
  std::copy(bdf_.x().begin(), bdf_.x().end(), x);
  bdf_.interpolate(t, scratch_w_.data(), scratch_x_.data(), xdot);
}

CallResult Integration::output(double tout, double& t, double* x, double* xdot) {
  Vector& x_free = scratch_x_;
  bdf_.interpolate(tout, scratch_w_.data(), x_free.data(), xdot);
  const bool at_step = tout == bdf_.t();
  if (!(at_step && system_.t() == tout)) {
    const PointStatus status = system_.move_to(tout);
    if (status == PointStatus::trouble) throw Failure(system_.trouble().status, system_.trouble().message());
    if (status == PointStatus::changed)
      throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                    format("the characteristic values do not hold at t = %.15g, an isolated point: choose another "
                           "output time.",
                           tout));
  }
  if (system_.inconsistency() > options_.consistency_tol) {
    if (!options_.ignore_inconsistency) throw Failure(SFDAE_INCONSISTENT_EQUATIONS, system_.inconsistency_message());
    inconsistent_ = true;
    counts_.inconsistency = std::max(counts_.inconsistency, system_.inconsistency());
  }
  if (must_restart_ && !at_step) {
    // The history is that of another leading term: x alone can be used.
    scratch_w_.resize(static_cast<std::size_t>(system_.leading_size()));
    system_.leading(x_free.data(), scratch_w_.data());
  }
  if (at_step) std::copy(bdf_.x().begin(), bdf_.x().end(), x);
  else system_.restore(scratch_w_.data(), x_free.data(), x);
  if (system_.differential() == 0) system_.consistent_derivative(x, direction_, xdot);
  else system_.correct_derivative(bdf_.leading_coefficient(), x, xdot);
  t = tout;
  return {};
}

}  // namespace sfdae::core
