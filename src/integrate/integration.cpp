// The driver of the integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/integration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "integrate/integration_events.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Attempts in a row that fail for want of a valid point before the call gives up.
constexpr int max_point_failures = 12;
// Of running means: they tell of the last six or so.
constexpr double forgetting = 0.15;
CallResult failure_result(const Failure& failure) { return {failure.status(), failure.what()}; }

}  // namespace

Integration::Integration(DaeSystem& system, std::unique_ptr<ChangeWatch> watch, const IntegrationOptions& options,
                         double t, double toward, const Vector& x, const Vector& xdot)
    : system_(system),
      options_(options),
      chosen_(options.method),
      watch_(std::move(watch)),
      direction_(toward < t ? -1.0 : 1.0),
      last_returned_(t),
      reductions_before_(system.counts().reductions),
      factorizations_before_(system.counts().factorizations),
      span_(std::fabs(toward - t)) {
  if (options.events != nullptr) forget_search(*options.events);
  create_stepper(options.method);
  set_options(options);
  first_step_ = stepper_->first_step(weights_, x.data(), xdot.data(), std::fabs(toward - t));
  begin(t, x, xdot);
  if (watch_) watch_->start(direction_);
}

Integration::Integration(DaeSystem& system, std::unique_ptr<ChangeWatch> watch, const IntegrationOptions& options,
                         Archive& saved)
    : system_(system), options_(options), chosen_(options.method), watch_(std::move(watch)) {
  create_stepper(options.method);
  set_options(options);
  archive(saved);
}

void Integration::create_stepper(Method method) {
  method_ = method == Method::bdf ? Method::bdf : Method::radau;
  if (method_ == Method::bdf) stepper_ = std::make_unique<Bdf>();
  else stepper_ = std::make_unique<Radau>();
}

void Integration::archive(Archive& archive) {
  // Bit 0: backward; bit 1: with events.
  const bool has_events = options_.events != nullptr;
  int kind = (direction_ < 0.0 ? 1 : 0) + (has_events ? 2 : 0);
  bool has_change = change_.has_value();
  archive.small(kind, must_restart_, has_change, chosen_, method_, outputs_);
  direction_ = (kind & 1) != 0 ? -1.0 : 1.0;
  if (archive.is_reading() && ((kind & 2) != 0) != has_events) throw_events_differ(has_events);
  if (archive.is_reading()) {
    if (method_ < Method::bdf || method_ > Method::radau || chosen_ < Method::bdf || chosen_ > Method::automatic)
      throw DamagedArchive();
    create_stepper(method_);
    set_options(options_);
  }
  if (chosen_ == Method::automatic) {
    archive.real(failure_rate_);
    archive.real(output_rate_);
  }
  IntegrationCounts all = counts();
  archive.counts(all.steps, all.error_failures);
  archive.counts(all.other_failures, all.reductions);
  long unused = 0;
  archive.counts(all.factorizations, unused);
  if (!options_.short_checkpoints)
    for (double* value : {&all.first_step, &all.smallest_kept, &all.inconsistency}) archive.real(*value);
  archive.real(first_step_);
  archive.real(last_returned_);
  stepper_->archive(archive, system_);
  if (!has_change && watch_) watch_->archive(archive);
  if (has_events) archive_events(archive);
  if (archive.is_reading()) {
    counts_ = all;
    reductions_before_ = system_.counts().reductions - all.reductions;
    factorizations_before_ = system_.counts().factorizations - all.factorizations;
    scratch_w_.resize(index(system_.leading_size()));
    scratch_x_.resize(index(system_.unknowns()));
    if (has_change) change_.emplace();
  }
  if (!has_change) return;
  CharacteristicValues& values = change_->new_values;
  archive.real(change_->t_before);
  archive.real(change_->t);
  archive.small(values.mu, values.d, values.a, values.u, values.v);
}

void Integration::set_options(const IntegrationOptions& options) {
  options_ = options;
  // Errors of nonlinear mechanical systems grow along the solution: the users of other codes know this factor.
  constexpr double nonlinear_safety = 0.2;
  weights_.set(options_.tolerances, stepper_->tightening(), system_.is_linear() ? 1.0 : nonlinear_safety);
  weights_.set_floor(system_.rounding_errors());
  if (!stepper_->x().empty()) weights_.update(stepper_->x().data());
  options_.stepping.interpolates = !options_.never_pass_output;
  stepper_->set_options(options_.stepping);
}

IntegrationCounts Integration::counts() const {
  IntegrationCounts counts = counts_;
  counts.reductions = system_.counts().reductions - reductions_before_;
  counts.factorizations = system_.counts().factorizations - factorizations_before_;
  return counts;
}

void Integration::begin(double t, const Vector& x, const Vector& xdot) {
  const double h = direction_ * (options_.initial_step > 0.0 ? options_.initial_step : first_step_);
  const std::size_t size = index(system_.leading_size());
  Vector w(size), wdot(size);
  system_.leading(x.data(), w.data());
  system_.leading_derivative(x.data(), xdot.data(), wdot.data());
  weights_.update(x.data());
  stepper_->start(system_, {t, x, xdot, w, wdot}, h);
  system_.accept();
  scratch_w_.resize(size);
  scratch_x_.resize(x.size());
}

CallResult Integration::advance(double tout, bool one_step, double& t, double* x, double* xdot) {
  if ((tout - last_returned_) * direction_ < 0.0)
    return {SFDAE_ILLEGAL_ARGUMENT, format("tout = %.15g lies before t = %.15g in the direction of integration. Use "
                                           "sfdae_start to change direction.",
                                           tout, last_returned_)};
  if (options_.stop_time && (*options_.stop_time - tout) * direction_ < 0.0)
    return {SFDAE_ILLEGAL_ARGUMENT, format("tout = %.15g lies beyond stop_time = %.15g.", tout, *options_.stop_time)};
  inconsistent_ = false;
  CallResult result;
  try {
    result = run(tout, one_step);
    if (result.status == SFDAE_OK) result = output(tout, t, x, xdot);
    else if (result.status > 0 || result.status == SFDAE_MAX_STEPS) return_consistent_point(t, x, xdot);
    else return_last_point(t, x, xdot);
  } catch (const Failure& failure) {
    return_last_point(t, x, xdot);
    result = failure_result(failure);
  } catch (...) {
    return_last_point(t, x, xdot);
    throw;
  }
  if (result.status == SFDAE_STOPPED) system_.take_stop_request();
  if (result.status == SFDAE_OK && inconsistent_)
    result = {SFDAE_INCONSISTENCY_IGNORED,
              format("redundant equations contradict each other (relative residual %.3g); ignored as asked for.",
                     counts_.inconsistency)};
  // A call that was stopped may be repeated with the same tout, even if the last step went past it.
  last_returned_ = (t - tout) * direction_ > 0.0 ? tout : t;
  return result;
}

void Integration::restart_at_last_point(Method method) {
  const double t = stepper_->state().t, step = std::fabs(stepper_->state().next_step);
  if (system_.move_to(t) == PointStatus::callback_error)
    throw Failure(system_.callback_error().status, system_.callback_error().message());
  const Vector x = stepper_->x();
  Vector xdot(x.size());
  system_.consistent_derivative(x.data(), direction_, xdot.data());
  if (method != method_) {
    create_stepper(method);
    set_options(options_);
    first_step_ = stepper_->first_step(weights_, x.data(), xdot.data(), 1e3 * step);
  }
  begin(t, x, xdot);
  must_restart_ = false;
}

CallResult Integration::run(double tout, bool one_step) {
  if (auto event = search_events(tout)) return *event;
  // The last call gave up with a step that tells nothing about the solution.
  if (must_restart_ && !change_ && !has_passed(tout)) restart_at_last_point(method_);
  for (long attempts = 0; !has_passed(tout); ++attempts) {
    if (system_.stop_is_requested())
      return {SFDAE_STOPPED,
              format("stopped on request at t = %.15g; the call can be repeated.", stepper_->state().t)};
    if (change_ && has_passed(change_->t_before)) return changed_result();
    if (attempts >= options_.max_steps)
      return {SFDAE_MAX_STEPS,
              format("%ld steps attempted without reaching tout = %.15g; t = %.15g. Call again, raise "
                     "max_steps, or loosen the tolerances.",
                     options_.max_steps, tout, stepper_->state().t)};
    if (weights_.rounding(stepper_->x().data()) > 1.0)
      return {SFDAE_TOLERANCE_TOO_SMALL,
              format("the tolerances are too small for the precision of the machine at t = %.15g: multiply them by "
                     "%.2g at least.",
                     stepper_->state().t, weights_.rounding(stepper_->x().data()))};
    if (is_better_off_with_bdf()) restart_at_last_point(Method::bdf);
    const long steps = counts_.steps;
    const auto result = attempt_step(tout);
    if (counts_.steps > steps)
      if (auto event = search_events(tout)) return *event;
    if (result) return *result;
    if (one_step && counts_.steps > steps && !has_passed(tout)) return {SFDAE_STEP_TAKEN, ""};
  }
  return {};
}

// Half of the attempts fail, or there are more outputs than stages: measured, BDF needs fewer reductions then.
bool Integration::is_better_off_with_bdf() const {
  constexpr double many_failures = 0.5, many_outputs = 5.0;
  return chosen_ == Method::automatic && method_ == Method::radau && system_.differential() > 0 &&
         (failure_rate_ > many_failures || output_rate_ > many_outputs);
}

double Integration::smallest_step(double tout) const {
  return 4.0 * 2.0 * unit_roundoff * std::max(std::fabs(stepper_->state().t), std::fabs(tout));
}

std::optional<double> Integration::limit() const {
  if (change_) return change_->t_before;
  return options_.stop_time;
}

double Integration::choose_step(double tout) const {
  const double t = stepper_->state().t;
  double h = std::fabs(stepper_->state().next_step);
  // Without differential equations nothing accumulates: the solution at tout is one reduction away.
  if (system_.differential() == 0 && stepper_->state().failures_in_a_row == 0) h = std::fabs(tout - t);
  if (options_.max_step > 0.0) h = std::min(h, options_.max_step);
  return direction_ * h;
}

std::optional<CallResult> Integration::attempt_step(double tout) {
  double h = choose_step(tout);
  const double t = stepper_->state().t;
  if (std::fabs(h) < smallest_step(tout)) {
    if (stepper_->state().failures_in_a_row > 0) return step_too_small(StepOutcome::error_too_large);
    h = direction_ * smallest_step(tout);
  }
  // No tiny rest before a limit, and not a bit beyond.
  double target = t + h;
  const auto end = limit();
  if (end && (target - *end) * direction_ > -1e-10 * std::fabs(h)) target = *end;
  // Steps that end at tout: nearly there counts as there; the step cut short says nothing about the next one. Where
  // interpolation would not be accurate this is the cheapest way, too.
  constexpr double nearly = 1e-4;
  double uncut = 0.0;
  const bool may_land = (options_.never_pass_output || !stepper_->state().interpolates_well) &&
                        !(end && (tout - *end) * direction_ > 0.0);
  if (may_land && (target - tout) * direction_ > -nearly * std::fabs(h)) {
    uncut = h;
    target = tout;
  }
  h = target - t;
  const StepOutcome outcome = stepper_->attempt(system_, target, weights_);
  failure_rate_ += forgetting * ((outcome == StepOutcome::accepted ? 0.0 : 1.0) - failure_rate_);
  if (outcome == StepOutcome::accepted) {
    if (std::fabs(uncut) > (1.0 + nearly) * std::fabs(h)) stepper_->set_next_step(uncut);
    return accept_step(h);
  }
  return handle_failure(outcome, h, tout);
}

std::optional<CallResult> Integration::accept_step(double h) {
  const PointQuality quality = system_.quality();
  const double inconsistency = quality.inconsistency;
  if (inconsistency > options_.consistency_tol) {
    if (!options_.ignore_inconsistency) {
      stepper_->withdraw();
      return CallResult{SFDAE_INCONSISTENT_EQUATIONS, system_.inconsistency_message()};
    }
    inconsistent_ = true;
  }
  counts_.inconsistency = std::max(counts_.inconsistency, inconsistency);
  if (!change_ && watch_) {
    change_ = watch_->find(stepper_->state().t);
    if (change_) {
      stepper_->withdraw();
      stepper_->set_next_step(h);
      return std::nullopt;
    }
  }
  if (watch_) watch_->accept();
  counts_.rounding = std::max(counts_.rounding, weights_.floor_ratio());
  counts_.smallest_kept =
      std::min({counts_.smallest_kept, quality.smallest_pivot, quality.kept_constraints, quality.kept_differential});
  stepper_->commit();
  system_.accept();
  if (counts_.steps++ == 0) counts_.first_step = h;
  output_rate_ += forgetting * (outputs_ - output_rate_);
  outputs_ = 0;
  if (options_.monitor != nullptr) {
    const sfdae_progress progress{sizeof(sfdae_progress),       stepper_->state().t, h,
                                  stepper_->state().last.order, counts_.steps,       system_.unknowns(),
                                  stepper_->x().data()};
    if (options_.monitor(&progress, options_.monitor_user) != 0)
      return CallResult{SFDAE_STOPPED, format("stopped by the monitor at t = %.15g; the call can be repeated.",
                                              stepper_->state().t)};
  }
  return std::nullopt;
}

std::optional<CallResult> Integration::handle_failure(StepOutcome outcome, double h, double tout) {
  switch (outcome) {
    case StepOutcome::error_too_large: ++counts_.error_failures; return std::nullopt;
    case StepOutcome::callback_error:
      if (!system_.callback_error().is_recoverable())
        return CallResult{system_.callback_error().status, system_.callback_error().message()};
      break;
    case StepOutcome::leading_changed: {
      // rank E is not constant, though the hypothesis holds: w = P x has no continuous meaning, w = E x has.
      must_restart_ = true;
      system_.give_up_projector();
      restart_at_last_point(method_);
      ++counts_.other_failures;
      return std::nullopt;
    }
    case StepOutcome::changed:
      if (std::fabs(h) > smallest_step(tout) * 64.0) {
        if (watch_) change_ = watch_->locate(stepper_->state().t, stepper_->state().tried_t);
        if (change_) {
          stepper_->withdraw();
          return std::nullopt;
        }
      } else {
        change_ = LocatedChange{stepper_->state().t, stepper_->state().tried_t,
                                system_.values_at(stepper_->state().tried_t)};
        return std::nullopt;
      }
      break;
    default: break;
  }
  ++counts_.other_failures;
  stepper_->reduce_after_failure(h);
  if (stepper_->state().failures_in_a_row > max_point_failures ||
      std::fabs(stepper_->state().next_step) < smallest_step(tout))
    return step_too_small(outcome);
  return std::nullopt;
}

CallResult Integration::step_too_small(StepOutcome outcome) {
  if (change_) return changed_result();
  must_restart_ = true;
  const double t = stepper_->state().t;
  if (outcome == StepOutcome::changed) {
    change_ = LocatedChange{t, stepper_->state().tried_t, system_.values_at(stepper_->state().tried_t)};
    return changed_result();
  }
  if (outcome == StepOutcome::callback_error)
    return {system_.callback_error().status, system_.callback_error().message() + " Smaller steps did not help."};
  if (outcome == StepOutcome::singular)
    return {SFDAE_SINGULAR,
            format("the matrix of the step is singular beyond t = %.15g for every step size tried.", t)};
  if (outcome == StepOutcome::not_converged)
    return {
        SFDAE_STEP_TOO_SMALL,
        format(
            "the nonlinear equations of the step have no solution near the predicted one beyond t = %.15g, however "
            "small the step. The solution may end or have a singularity there.",
            t)};
  if (outcome == StepOutcome::not_finite)
    return {SFDAE_STEP_TOO_SMALL, format("the solution overflows beyond t = %.15g.", t)};
  const int i = weights_.worst(stepper_->error().data());
  std::string message = format(
      "the error test fails at t = %.15g with the smallest step, %.3g; the error sits in "
      "x[%d] = %.6g.",
      t, stepper_->state().next_step, i, stepper_->x()[index(i)]);
  if (weights_.tolerance(i, stepper_->x().data()) == 0.0) message += " Its tolerance is zero there: give it an atol.";
  else message += " The data may jump there, or the solution has a singularity: stop at such a point and restart.";
  return {SFDAE_STEP_TOO_SMALL, message};
}

CallResult Integration::changed_result() const {
  return {SFDAE_CHARACTERISTICS_CHANGED,
          "characteristic values changed from (" + describe(system_.analysis().values) + ") to (" +
              describe(change_->new_values) +
              format(") at t = %.12g. Call sfdae_analyze and sfdae_start after that point.", change_->t) +
              system_.about_change()};
}

void Integration::return_last_point(double& t, double* x, double* xdot) {
  if (options_.events != nullptr && options_.events->search.is_started()) return return_searched_point(t, x, xdot);
  t = stepper_->state().t;
  std::copy(stepper_->x().begin(), stepper_->x().end(), x);
  stepper_->interpolate({t, scratch_w_.data(), scratch_x_.data(), xdot});
}

// The last point with its constraints fulfilled to rounding; as it is where that fails.
void Integration::return_consistent_point(double& t, double* x, double* xdot) {
  return_last_point(t, x, xdot);
  if (system_.is_linear() || t != stepper_->state().t) return;
  try {
    if (system_.move_to(t) != PointStatus::ok) return;
    system_.restore(nullptr, stepper_->x().data(), x);
    if (wants_slopes_) system_.correct_derivative(stepper_->state().last.leading_coefficient, x, xdot);
  } catch (const Failure&) {
    std::copy(stepper_->x().begin(), stepper_->x().end(), x);
  }
}

CallResult Integration::output(double tout, double& t, double* x, double* xdot) {
  outputs_ = std::min(outputs_ + 1, 1000);
  if (has_searched_to(tout)) return_searched_point(t, x, xdot);
  else evaluate(tout, true, x, xdot);
  t = tout;
  return {};
}

void Integration::evaluate(double tout, bool may_refine, double* x, double* xdot) {
  Vector& x_free = scratch_x_;
  const PointValues point{tout, scratch_w_.data(), x_free.data(), xdot};
  stepper_->interpolate(point);
  const bool at_step = tout == stepper_->state().t;
  if (!(at_step && system_.t() == tout)) {
    const auto move = [&] {
      return at_step || !may_refine ? system_.move_to(tout) : stepper_->refine(system_, weights_, point);
    };
    PointStatus status = move();
    // There is no other point to try; the same one again helps where a function failed for reasons that have passed.
    if (status == PointStatus::callback_error && system_.callback_error().is_recoverable()) status = move();
    if (status == PointStatus::callback_error)
      throw Failure(system_.callback_error().status, system_.callback_error().message());
    if (status == PointStatus::changed)
      throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                    format("the characteristic values do not hold at t = %.15g, an isolated point: choose another "
                           "output time.",
                           tout));
  }
  const double inconsistency = system_.quality().inconsistency;
  if (inconsistency > options_.consistency_tol) {
    if (!options_.ignore_inconsistency) throw Failure(SFDAE_INCONSISTENT_EQUATIONS, system_.inconsistency_message());
    inconsistent_ = true;
    counts_.inconsistency = std::max(counts_.inconsistency, inconsistency);
  }
  if (must_restart_ && !at_step) {
    // The history is that of another leading term: x alone can be used.
    scratch_w_.resize(index(system_.leading_size()));
    system_.leading(x_free.data(), scratch_w_.data());
  }
  // Iterations for nonlinear equations end when errors are small against the tolerances: the constraints want more.
  if (at_step && system_.is_linear()) std::copy(stepper_->x().begin(), stepper_->x().end(), x);
  else system_.restore(scratch_w_.data(), at_step ? stepper_->x().data() : x_free.data(), x);
  if (system_.check_ranks() == PointStatus::changed)
    throw Failure(
        SFDAE_CHARACTERISTICS_CHANGED,
        format("the characteristic values known do not hold at t = %.15g any more: they have changed since t = "
               "%.15g or before. Analyze the problem after the change.",
               tout, stepper_->state().t - stepper_->state().last.h));
  // The slope of a polynomial of high degree over a long step is not as accurate as x is.
  const bool is_within_long_step = method_ == Method::radau && !at_step && wants_slopes_;
  if (!wants_slopes_ && !system_.is_linear()) std::fill_n(xdot, system_.unknowns(), 0.0);
  else if (system_.differential() == 0) system_.consistent_derivative(x, direction_, xdot);
  else if (!(is_within_long_step && system_.exact_derivative(x, xdot)))
    system_.correct_derivative(stepper_->state().last.leading_coefficient, x, xdot);
  const std::size_t n = index(system_.unknowns());
  if (!all_finite(xdot, n)) system_.consistent_derivative(x, direction_, xdot);
  if (!all_finite(x, n) || !all_finite(xdot, n))
    throw Failure(SFDAE_NOT_FINITE, format("the solution or its derivative overflows at t = %.15g.", tout));
}

}  // namespace sfdae::core
