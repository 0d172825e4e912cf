// Driver of the integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/integration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "expression/sliding_layers.h"
#include "integrate/integration_results.h"
#include "integrate/kinks.h"
#include "integrate/step_events.h"
#include "integrate/step_target.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Maximum of consecutive attempts without a valid point before the call fails: steps are then shorter by 4^12, about
// 1e7. (Chosen.)
constexpr int max_point_failures = 12;
// Changes of the characteristic values are located within steps that are so many times longer than the smallest one;
// shorter steps locate them already. (Chosen, so that at least six bisections remain.)
constexpr double room_to_locate = 64.0;
// Accuracy of the time of a singular point to be passed, relative to the steps near it. (Chosen: extrapolation does not
// use nearer points.)
constexpr double accuracy_for_passing = 1e-6;

}  // namespace

Integration::Integration(DaeSystem& system, std::unique_ptr<ChangeWatch> watch, const IntegrationOptions& options,
                         const InitialPoint& point)
    : options_(options),
      integrator_(system, point.toward < point.t ? -1.0 : 1.0),
      choice_{options.method},
      counts_(system),
      watch_(std::move(watch)),
      start_(point.t),
      last_returned_(point.t),
      span_(std::fabs(point.toward - point.t)) {
  if (options_.events != nullptr) options_.events->search.reset();
  integrator_.create(options_.method, options_);
  integrator_.first_step =
      integrator_.stepper->first_step(integrator_.weights, point.x.data(), point.xdot.data(), span_);
  integrator_.start(point.t, point.x, point.xdot, options_);
  resize_workspace();
  inputs_.open_account(span_);
  if (watch_) watch_->start(integrator_.direction);
  start_trail();
}

void Integration::set_options(const IntegrationOptions& options) {
  IntegrationOptions copy = options;
  integrator_.set_options(copy);
  options_ = std::move(copy);
}

IntegrationCounts Integration::counts() const {
  IntegrationCounts counts = counts_.all(integrator_.system);
  counts.inconsistency = integrator_.contradictions.largest;
  return counts;
}

CallResult Integration::advance(double tout, bool one_step, double& t, double* x, double* xdot) {
  const double direction = integrator_.direction;
  Contradictions& contradictions = integrator_.contradictions;
  if (xdot == nullptr) xdot = output_.unused_slopes();
  const double goal = beside_kink(options_, integrator_, tout);
  if ((tout - last_returned_) * direction < 0.0) return result_of_wrong_direction(tout, last_returned_);
  if (options_.stop_time && (*options_.stop_time - tout) * direction < 0.0)
    return result_beyond_stop_time(tout, *options_.stop_time);
  contradictions.ignored_in_call = false;
  // A call that was stopped may be repeated with the same tout, even if the last step went past it.
  const auto note_returned = [&] { last_returned_ = (t - tout) * direction > 0.0 ? tout : t; };
  CallResult result;
  try {
    result = run(goal, one_step);
    if (result.status == SFDAE_OK) {
      output(conditions_.beside(goal), tout, x, xdot);
      t = tout;
    } else if (result.status > 0 || result.status == SFDAE_MAX_STEPS) {
      return_consistent_point(t, x, xdot);
    } else {
      return_last_point(t, x, xdot);
    }
  } catch (const Failure& failure) {
    return_last_point(t, x, xdot);
    note_returned();
    result = {failure.status(), failure.what()};
  } catch (...) {
    return_last_point(t, x, xdot);
    note_returned();
    throw;
  }
  note_returned();
  if (result.status == SFDAE_STOPPED) integrator_.system.take_stop_request();
  if (result.status == SFDAE_OK && contradictions.ignored_in_call)
    result = result_of_ignored_contradictions(contradictions.largest);
  return result;
}

CallResult Integration::interpolate(double t, bool may_interpolate, double* x, double* xdot) {
  const StepState state = integrator_.stepper->state();
  const double start = state.t - state.last.h;
  const double place = conditions_.beside(beside_kink(options_, integrator_, t));
  if ((place - start) * integrator_.direction < 0.0 || (state.t - place) * integrator_.direction < 0.0)
    return result_outside_last_step(t, start, state.t);
  // The event search uses consistent points.
  const bool may = may_interpolate && options_.interpolates_outputs && options_.events == nullptr;
  const PointRequest request{place, true, slopes_, may};
  output_.evaluate_aside(integrator_, request_beside_kink(t, request), options_, x, xdot);
  return {};
}

// ---- Steps -----------------------------------------------------------------------------------------------------

CallResult Integration::run(double tout, bool one_step) {
  if (auto event = search_events(tout)) return std::move(*event);
  // The last call failed with an unsuitable step size.
  if (integrator_.must_restart && !change_ && !integrator_.has_passed(tout)) restart(integrator_.method);
  for (long attempts = 0; !integrator_.has_passed(tout); ++attempts) {
    if (auto stopped = obstacle(attempts, tout)) return std::move(*stopped);
    // Passing a singular point may have led beyond tout.
    if (integrator_.has_passed(tout)) break;
    const double t = integrator_.stepper->state().t;
    if (conditions_.is_due()) {
      change_branches(tout);
      continue;
    }
    if (hidden_.at) {
      cross_jump(*std::exchange(hidden_.at, std::nullopt), tout);
      continue;
    }
    keep_to_piece(options_, integrator_.system, {t, tout, integrator_.direction}, start_);
    if (const auto gap = jump_at(options_, t, integrator_.direction)) {
      cross_jump(*gap, tout);
      continue;
    }
    if (integrator_.method == Method::radau && integrator_.system.differential() > 0 && choice_.prefers_bdf())
      restart(Method::bdf);
    else if (is_at_kink(options_, integrator_.stepper->state())) restart_at_kink();
    limit_errors_in_layers();
    if (!layers_fit()) return result_of_layers(t);
    const long steps = counts_.own.steps;
    const auto result = attempt_step(tout);
    if (lacks_branches()) return result_without_branches(t);
    const bool is_step_taken = counts_.own.steps > steps;
    notice_idle_steps();
    if (is_idle() && !integrator_.has_passed(tout)) return result_of_idle_steps(t, regularity_.idle_t);
    if (is_step_taken)
      if (auto event = search_events(tout)) return std::move(*event);
    if (is_step_taken && adjoint() == nullptr) conditions_.demand_distinct(integrator_);
    if (result) return *result;
    if (one_step && is_step_taken && !integrator_.has_passed(tout)) return {SFDAE_STEP_TAKEN, ""};
  }
  return {};
}

// Discards data from before the kink: polynomials, whose errors the error test may miss
// (docs/design/inputs_and_discontinuities.md), and data of the search for changes of the characteristic values.
void Integration::restart_at_kink() {
  restart(integrator_.method);
  inputs_.note_switch(integrator_.stepper->state().t);
  if (watch_) watch_->start(integrator_.direction);
  start_trail();
}

std::optional<CallResult> Integration::obstacle(long attempts, double tout) {
  const double t = integrator_.stepper->state().t;
  if (integrator_.system.stop_is_requested()) return result_of_stop_request(t);
  if (change_ && integrator_.has_passed(change_->t_before))
    if (auto change = meet_change()) return change;
  if (attempts >= options_.max_steps) return result_of_many_steps(options_.max_steps, tout, t);
  const double rounding = integrator_.weights.rounding(integrator_.stepper->x().data());
  if (rounding > 1.0) return result_of_small_tolerances(t, rounding);
  return integrator_.differences.lasting_excess(integrator_.weights);
}

void Integration::restart(Method method) {
  resize_workspace();
  integrator_.restart(method, options_);
  if (!companion_) return;
  integrator_.must_restart = true;  // restart again if that fails
  companion_->start(integrator_);
  integrator_.must_restart = false;
}

std::optional<CallResult> Integration::attempt_step(double tout) {
  Stepper& stepper = *integrator_.stepper;
  const StepState state = stepper.state();
  double size = std::fabs(state.next_step);
  // Without differential equations no errors accumulate: the unique solution of linear equations at tout needs one
  // reduction. Nonlinear equations may have other solutions, to which long steps may lead.
  if (integrator_.system.differential() == 0 && integrator_.system.is_linear() && state.failures_in_a_row == 0)
    size = std::fabs(tout - state.t);
  if (options_.max_step > 0.0) size = std::min(size, options_.max_step);
  if (approach_ && approach_->is_reached) size = std::min(size, approach_->step);
  size = fine_step(size);
  const double smallest = Integrator::smallest_step(state.t, tout);
  if (size < smallest) {
    if (state.failures_in_a_row > 0 && !ends_as_located()) return give_up(StepOutcome::error_too_large);
    size = smallest;
  }
  // In layers polynomials are less accurate than the ends of steps, and points between the ends may not be found.
  const bool is_in_layer = layers() != nullptr && layers()->are_entered();
  const StepBounds bounds{integrator_.direction, tout, limit_of_step(state.t, tout, size),
                          options_.never_pass_output || adjoint() != nullptr || is_in_layer};
  StepTarget target = choose_target(state, size, bounds);
  if (const double seen = noticing_step(target.t); seen < std::fabs(target.t - state.t))
    target = choose_target(state, std::max(seen, smallest), bounds);
  const double h = target.t - state.t;
  std::optional<JumpTest> jumps;
  if (crosses_kink(options_, state.t, h)) jumps.emplace(index(integrator_.system.unknowns()));
  integrator_.weights.set_part(inputs_.allowed_error(state.t, h));
  if (companion_) companion_->prepare(integrator_, options_, target.t);
  StepOutcome outcome = stepper.attempt(integrator_.system, target.t, integrator_.weights);
  if (outcome != StepOutcome::accepted)
    note(outcome == StepOutcome::callback_error ? AttemptEnd::failed : AttemptEnd::refused);
  if (outcome == StepOutcome::accepted && companion_) outcome = companion_->attempt(integrator_, options_.tolerances);
  if (outcome != StepOutcome::accepted) {
    auto result = handle_failure(outcome, h, tout);
    if (adjoint() == nullptr) try_with_branches(outcome, h);
    hidden_.end.reset();
    choice_.note_attempt(false);
    return result;
  }
  if (target.is_cut_short(h)) stepper.set_next_step(target.uncut);
  return accept_step(h, state.next_step, tout, jumps);
}

// Detects attempts without progress: with flat equations steps may go back and forth, however small they are.
void Integration::notice_idle_steps() {
  constexpr int many = 200;
  constexpr double next_to_nothing = 10.0, part = 1e-3;  // tolerances; of the interval of interest. (Chosen.)
  if (++regularity_.attempts < many) return;
  const StepState state = integrator_.stepper->state();
  const std::vector<double>& x = integrator_.stepper->x();
  bool is_idle = std::fabs(state.t - regularity_.idle_t) <= part * span_;
  for (std::size_t i = 0; is_idle && i < x.size(); ++i) {
    const double tolerance = integrator_.weights.tolerance(static_cast<int>(i), x.data());
    is_idle = std::fabs(x[i] - regularity_.idle_x[i]) <= next_to_nothing * tolerance;
  }
  regularity_.is_idle = is_idle;
  if (!regularity_.is_idle) regularity_.goes_on_idle = false;
  std::copy(x.begin(), x.end(), regularity_.idle_x.begin());
  regularity_.idle_t = state.t;
  regularity_.attempts = 0;
}

// Limits errors of parts of branches so that errors that remain undetected for times as short as its root do not affect
// x.
void Integration::limit_errors_in_layers() {
  constexpr double exponent = 2.0 / 3.0;
  if (layers() == nullptr) return integrator_.weights.set_ceiling(nullptr);
  const double part = std::pow(integrator_.weights.tightest(integrator_.stepper->x().data()), exponent);
  layers()->find_limits(layer_point(), part, regularity_.limits);
  integrator_.weights.set_ceiling(regularity_.limits.data());
}

LayerPoint Integration::layer_point() {
  const std::vector<double>& x = integrator_.stepper->x();
  regularity_.tolerances.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    regularity_.tolerances[i] = integrator_.weights.tolerance(static_cast<int>(i), x.data());
  return {integrator_.stepper->state().t, x.data(), regularity_.tolerances.data(), has_companion()};
}

SlidingLayers* Integration::layers() const {
  return options_.conditions != nullptr ? options_.conditions->layers() : nullptr;
}

// After a failed step of size h: the same step with branches held, or a much shorter one without.
void Integration::try_with_branches(StepOutcome outcome, double h) {
  constexpr double shorter = 0.25;  // as after failures without a point
  const bool was_held = !conditions_.is_plain() && options_.conditions->can_be_held();
  const double next = integrator_.stepper->state().next_step;
  if (conditions_.is_tried_with_branches_held(integrator_, outcome) && !change_)
    integrator_.stepper->set_next_step(h);
  else if (was_held && std::fabs(next) > shorter * std::fabs(h)) integrator_.stepper->set_next_step(shorter * h);
}

// Adapts sizes to the present system.
void Integration::resize_workspace() {
  output_.resize(integrator_.system);
  if (options_.inputs != nullptr) inputs_.resize(integrator_.system, *options_.inputs);
  conditions_.resize(options_.conditions, index(integrator_.system.unknowns()));
  const std::size_t n = index(integrator_.system.unknowns());
  if (options_.conditions != nullptr)
    for (std::vector<double>* const each : {&regularity_.limits, &regularity_.slopes, &regularity_.tolerances})
      each->resize(n);
  regularity_.idle_x.resize(n, std::numeric_limits<double>::infinity());
  if (options_.hides_switches) hidden_.test.resize(index(integrator_.system.unknowns()));
}

// Step size toward t that does not miss changes of inputs; in gaps inputs switch.
double Integration::noticing_step(double t) {
  const StepState state = integrator_.stepper->state();
  const double h = t - state.t;
  const bool is_watched = options_.inputs != nullptr && integrator_.system.differential() > 0 && h != 0.0 &&
                          !crosses_kink(options_, state.t, h);
  return std::fabs(is_watched ? inputs_.noticing_step(integrator_, *options_.inputs, h) : h);
}

// Latest end of the next step from t, which may end at tout or have that size; empty: not limited.
std::optional<double> Integration::limit_of_step(double t, double tout, double size) const {
  constexpr double longer = 1.001;  // than steps extended to end at tout (step_target.cpp)
  std::optional<double> limit = options_.stop_time;
  if (conditions_.end()) limit = conditions_.end();
  if (hidden_.end) limit = hidden_.end;
  if (approach_ && !approach_->is_reached) limit = approach_->t;
  if (change_) limit = change_->t_before;
  const std::optional<double> kink = next_kink(options_, {t, tout, integrator_.direction}, longer * size);
  return kink && (!limit || (*limit - *kink) * integrator_.direction > 0.0) ? kink : limit;
}

// wanted: the step size before limits reduced it to h. jumps: set if the step crosses a gap.
std::optional<CallResult> Integration::accept_step(double h, double wanted, double tout,
                                                   std::optional<JumpTest>& jumps) {
  DaeSystem& system = integrator_.system;
  Contradictions& contradictions = integrator_.contradictions;
  const MethodChoice choice = choice_;
  choice_.note_attempt(true);
  const PointQuality quality = system.quality();
  if (!contradictions.tolerate(quality.inconsistency, options_)) {
    withdraw();
    return CallResult{SFDAE_INCONSISTENT_EQUATIONS, system.inconsistency_message()};
  }
  contradictions.largest = std::max(contradictions.largest, quality.inconsistency);
  const bool is_across_kink = jumps.has_value();
  bool is_searched = true, is_jump = false;
  std::vector<PassedSwitch> passed;
  try {
    is_jump = jumps && (jumps->has_jump(integrator_, adjoint() != nullptr) || moves_with_parameters(h));
    if (!is_across_kink && is_tried_again(h)) return std::nullopt;
    if (!is_across_kink && watch_ && !change_) {
      const StepSearch search = watch_->find(integrator_.stepper->state().t);
      if (has_found_change(search, h)) return std::nullopt;
      is_searched = search.is_complete;
    }
    if (!is_across_kink) passed = conditions_.passed();
    if (is_searched && !is_jump)
      integrator_.differences.accept(system, integrator_.weights, integrator_.stepper->tried_x().data(), false);
  } catch (...) {
    // The next call repeats this step.
    withdraw();
    integrator_.stepper->set_next_step(wanted);
    choice_ = choice;
    throw;
  }
  if (is_jump) {
    const bool is_large = jumps->is_large(integrator_);
    withdraw();
    cross_gap(tout, is_large);
    return std::nullopt;
  }
  if (!is_searched) {
    withdraw();
    note(AttemptEnd::failed);
    return handle_failure(StepOutcome::not_searched, h, tout);
  }
  if (watch_) watch_->accept();
  IntegrationCounts& counts = counts_.own;
  counts.rounding = std::max(counts.rounding, integrator_.weights.floor_ratio());
  counts.smallest_kept =
      std::min({counts.smallest_kept, quality.smallest_pivot, quality.kept_constraints, quality.kept_differential});
  return take_step(h, std::move(passed), is_across_kink);
}

// The step tried becomes the last one. passed: conditions on x that have switched in it. No memory is allocated before
// all data of the step are in place.
std::optional<CallResult> Integration::take_step(double h, std::vector<PassedSwitch> passed, bool is_across_kink) {
  IntegrationCounts& counts = counts_.own;
  const StepState before = integrator_.stepper->state();
  integrator_.stepper->commit();
  integrator_.system.accept();
  conditions_.commit(integrator_);
  if (layers() != nullptr && layers()->are_entered()) switches_.note_motion_along_surfaces(std::fabs(h));
  hidden_.end.reset();
  inputs_.commit(before.t, h, integrator_.weights.part() * before.tried_error);
  if (companion_) companion_->commit(integrator_);
  if (counts.steps++ == 0) counts.first_step = h;
  choice_.note_step();
  if (approach_ && approach_->is_reached) approach_.reset();
  else if (approach_ && integrator_.has_passed(approach_->t)) approach_->is_reached = true;
  if (is_across_kink) passed = options_.breakpoints->passed(before.t, before.t + h);
  switches_.note(std::move(passed), false);
  if (auto excess = integrator_.differences.lasting_excess(integrator_.weights)) return excess;
  if (is_across_kink) record_gap(before.t, integrator_.stepper->state().t, integrator_.stepper->x());
  else record_step(before.t);
  extend_trail(before.t);
  return call_monitor(h);
}

// Callbacks do not tell when they switch. If E x moves differently from its slopes, steps become shorter until slopes
// explain the movement, or x is known to jump within the next step.
bool Integration::may_hide_jump(double h) {
  constexpr double clear = 5.0, clear_at_start = 50.0, shorter = 0.25;  // tolerances; of the step. (Chosen.)
  DaeSystem& system = integrator_.system;
  // Without differential equations points are independent. Before the first step no slope is known for comparison.
  if (!system.differentiates() || system.differential() == 0 || adjoint() != nullptr ||
      integrator_.stepper->state().last.order == 0)
    return false;
  const double at_start = hidden_.test.unexplained_at_start(integrator_);
  if (!std::isgreater(at_start, clear)) return false;
  const double unexplained = hidden_.test.unexplained(integrator_);
  // If callbacks lack the derivatives for slopes at the end, the start alone decides, less accurately.
  if (std::isinf(unexplained) ? at_start <= clear_at_start : !std::isgreater(unexplained, clear)) return false;
  const double t = integrator_.stepper->state().t;
  withdraw();
  if (std::fabs(h) * shorter < Integrator::smallest_step(t, start_ + integrator_.direction * span_)) {
    hidden_.at = TimeBreakpoints::Gap{std::min(t, t + h), std::max(t, t + h), true};
    hidden_.end.reset();
    integrator_.stepper->set_next_step(h);
  } else {
    integrator_.stepper->set_next_step(shorter * h);
    hidden_.end = t + shorter * h;
  }
  return true;
}

bool Integration::turns_in_step() {
  constexpr int places = 8;  // within the step. (Chosen.)
  if (layers() == nullptr || !layers()->are_entered()) return false;
  const PointsOfCurve points = integrator_.stepper->points_of_tried();
  const std::size_t n = regularity_.limits.size();
  for (int k = 1; k <= places; ++k) {
    const double t = k < places ? points.t[0] + k * (points.t[1] - points.t[0]) / places : points.t[1];
    points.evaluate(t, n, regularity_.limits.data(), regularity_.slopes.data());
    if (layers()->turn({t, regularity_.limits.data(), regularity_.tolerances.data(), has_companion()})) return true;
  }
  return false;
}

// If a surface's conditions change the side on which they hold within the step, the step must be so short that x hardly
// moves.
bool Integration::ends_before_turn(double h) {
  constexpr double shorter = 0.25, located = 1e-2;  // of the step; tolerances. (Chosen.)
  const Stepper& stepper = *integrator_.stepper;
  const double t = stepper.state().t;
  if (!turns_in_step()) return false;
  for (std::size_t i = 0; i < regularity_.limits.size(); ++i)
    regularity_.limits[i] = stepper.tried_x()[i] - stepper.x()[i];
  const double moved = integrator_.weights.norm(regularity_.limits.data());
  if (moved <= located || std::fabs(h) * shorter < Integrator::smallest_step(t, t + h)) return false;
  withdraw();
  integrator_.stepper->set_next_step(shorter * h);
  return true;
}

// True if the step of size h from the same point is repeated with another end, because a condition on x switches.
bool Integration::is_tried_again(double h) {
  const double t = integrator_.stepper->state().t;
  if (options_.hides_switches && !conditions_.explain_step(integrator_) && may_hide_jump(h)) return true;
  if (ends_before_turn(h)) return true;
  if (!conditions_.steps_with_jump(integrator_)) {
    if (adjoint() == nullptr) {
      if (conditions_.judge(integrator_, has_companion()) == ConditionSteps::Verdict::accepted) return false;
    } else if (!conditions_.ends_between_switches(integrator_)) {
      if (conditions_.may_jump(integrator_, true)) throw_jump_with_sensitivities(t);
      return false;
    }
  }
  withdraw();
  if (!conditions_.is_due()) integrator_.stepper->set_next_step(std::copysign(*conditions_.end() - t, h));
  return true;
}

// The values are those that interpolate() returns if outputs may be interpolated. If that fails the polynomial is
// recorded as it is, with unknown accuracy.
void Integration::record_step(double from) {
  const std::shared_ptr<SolutionPieces> solution = recording_.solution.lock();
  if (!solution) return;
  Stepper& stepper = *integrator_.stepper;
  const double t = stepper.state().t;
  const auto sample = [&](double at, double* x) {
    try {
      output_.evaluate_aside(integrator_, {at, true, Slopes::none, true}, options_, x, nullptr);
      return true;
    } catch (const Failure& failure) {
      if (ends_everything(failure.status())) throw;
      output_.interpolate(stepper, at, x, nullptr);
      return false;
    }
  };
  const bool continues = std::exchange(recording_.is_on, false);
  add_piece(*solution, {from, t, continues, sample, {}});
}

// Samples are those of all unknowns; a failure ends the recording.
void Integration::add_piece(SolutionPieces& solution, SolutionPieces::Step step) {
  recording_.is_on = false;
  const int count = options_.recorded > 0 ? options_.recorded : integrator_.system.unknowns();
  std::vector<double> all(index(integrator_.system.unknowns()));
  const auto sample = [&](double t, double* x) {
    const bool is_accurate = step.sample(t, all.data());
    std::copy_n(all.begin(), count, x);
    return is_accurate;
  };
  const auto tolerance = [&](int i, const double* x) { return integrator_.weights.tolerance(i, x); };
  solution.add(count, {step.a, step.b, step.continues, sample, tolerance});
  recording_.is_on = true;
}

// After a change was found, the step of size h is repeated up to the change.
bool Integration::has_found_change(const StepSearch& search, double h) {
  const std::optional<LocatedChange>& found = search.change;
  if (!found) return false;
  withdraw();
  integrator_.stepper->set_next_step(h);
  refine_steps(h);
  if (found->uncertainty > 0.0) look_closer(*found, h);
  else change_ = found;
  return true;
}

// Confirms a suspected change: a step up to the earliest possible time, and one over the interval of uncertainty.
void Integration::look_closer(const LocatedChange& suspect, double h) {
  const double t = integrator_.stepper->state().t, before = suspect.t - integrator_.direction * suspect.uncertainty;
  const bool is_there = (before - t) * integrator_.direction < suspect.uncertainty;
  approach_ = Approach{before, is_there ? std::fabs(suspect.t - t) + suspect.uncertainty : 2.0 * suspect.uncertainty,
                       is_there};
  if (is_there) integrator_.stepper->set_next_step(std::copysign(approach_->step, h));
}

std::optional<CallResult> Integration::call_monitor(double h) const {
  if (options_.monitor == nullptr) return std::nullopt;
  const StepState state = integrator_.stepper->state();
  const sfdae_progress progress{
      sizeof(sfdae_progress),         state.t, h, state.last.order, counts_.own.steps, integrator_.system.unknowns(),
      integrator_.stepper->x().data()};
  if (options_.monitor(&progress, options_.monitor_user) == 0) return std::nullopt;
  return result_of_monitor_stop(state.t);
}

// ---- Failures --------------------------------------------------------------------------------------------------

std::optional<CallResult> Integration::handle_failure(StepOutcome outcome, double h, double tout) {
  DaeSystem& system = integrator_.system;
  IntegrationCounts& counts = counts_.own;
  if (outcome == StepOutcome::callback_error && !system.callback_error().is_recoverable())
    return CallResult{system.callback_error().status, system.callback_error().message()};
  if (outcome != StepOutcome::changed && crosses_kink(options_, integrator_.stepper->state().t, h)) {
    cross_gap(tout, true);
    return std::nullopt;
  }
  if (outcome == StepOutcome::error_too_large) {
    ++counts.error_failures;
    return std::nullopt;
  }
  if (outcome == StepOutcome::leading_changed) {
    // rank E is not constant, though the hypothesis holds: w = P x is discontinuous, w = E x is not.
    integrator_.must_restart = true;
    system.give_up_projector();
    restart(integrator_.method);
    ++counts.other_failures;
    return std::nullopt;
  }
  refine_steps(h);
  if (outcome == StepOutcome::changed && has_located_change(h, tout)) return std::nullopt;
  ++counts.other_failures;
  if (!change_ && watch_ &&
      (outcome == StepOutcome::not_converged || outcome == StepOutcome::singular ||
       outcome == StepOutcome::changed)) {
    change_ = watch_->find_ahead(h);
    if (change_) return std::nullopt;
  }
  integrator_.stepper->reduce_after_failure(h);
  note(AttemptEnd::reduced);
  const StepState state = integrator_.stepper->state();
  // With conditions every other attempt has branches held, and regularized conditions need much shorter steps.
  const int most = (options_.conditions != nullptr ? 4 : 1) * max_point_failures;
  if (state.failures_in_a_row > most || std::fabs(state.next_step) < Integrator::smallest_step(state.t, tout))
    return give_up(outcome);
  return std::nullopt;
}

bool Integration::has_located_change(double h, double tout) {
  if (change_) return false;
  const StepState state = integrator_.stepper->state();
  const double located = branches_.fine ? accuracy_for_passing * branches_.fine->step : 0.0;
  if (!(std::fabs(h) > std::max(Integrator::smallest_step(state.t, tout) * room_to_locate, located))) {
    change_ = change_at_failure();
    return true;
  }
  if (watch_) change_ = watch_->locate(state.t, state.tried_t);
  if (change_) withdraw();
  return change_.has_value();
}

// The change lies between the last point and the one tried.
LocatedChange Integration::change_at_failure() const {
  const StepState state = integrator_.stepper->state();
  return {state.t, state.tried_t, integrator_.system.values_at(state.tried_t), 0.0,
          integrator_.system.vanishing_part()};
}

// A change to which failures of steps point.
std::optional<LocatedChange> Integration::change_nearby() const {
  const std::optional<double> t = integrator_.system.change_nearby();
  if (!t) return std::nullopt;
  return LocatedChange{integrator_.stepper->state().t, *t, integrator_.system.values_at(*t), 0.0,
                       integrator_.system.vanishing_part()};
}

std::optional<CallResult> Integration::give_up(StepOutcome outcome) {
  if (!change_) {
    if (outcome == StepOutcome::changed) change_ = change_at_failure();
    else if (outcome != StepOutcome::callback_error) change_ = watch_ ? watch_->find_beyond() : change_nearby();
    integrator_.must_restart = true;
  }
  if (change_) return meet_change();
  if (outcome != StepOutcome::callback_error && has_passed_obstacle()) return std::nullopt;
  // Errors of finite-difference derivatives look like jumps of the solution.
  if (auto excess = integrator_.differences.excess(integrator_.weights)) return *excess;
  return result_of_smallest_step(outcome, integrator_);
}

// ---- Points returned -------------------------------------------------------------------------------------------

std::optional<CallResult> Integration::search_events(double tout) {
  if (options_.events == nullptr) return std::nullopt;
  const EventSearch& search = options_.events->search;
  const SearchedStep step{*options_.events, integrator_, output_, options_};
  if (!search.is_started()) start_search(step, last_returned_, span_);
  if (!search_step(step, tout)) return std::nullopt;
  return result_of_event(search.t());
}

void Integration::return_last_point(double& t, double* x, double* xdot) {
  Events* const events = options_.events;
  if (events == nullptr || !events->search.is_started()) return output_.last_point(*integrator_.stepper, t, x, xdot);
  // After a failure the slopes are those of the polynomial.
  if (!events->has_slopes)
    output_.interpolate(*integrator_.stepper, events->search.t(), events->rough.x.data(),
                        events->searched.xdot.data());
  return_searched_point(*events, t, x, xdot);
}

void Integration::return_consistent_point(double& t, double* x, double* xdot) {
  if (options_.events != nullptr && options_.events->search.is_started())
    complete_slopes({*options_.events, integrator_, output_, options_});
  return_last_point(t, x, xdot);
  if (integrator_.system.is_linear() || options_.interpolates_outputs || t != integrator_.stepper->state().t) return;
  output_.make_consistent(integrator_, slopes_, x, xdot);
}

// place: time at which the solution for t is evaluated.
void Integration::output(double place, double t, double* x, double* xdot) {
  if (branches_.passage && branches_.passage->has(place)) return branches_.passage->evaluate(place, x, xdot);
  double searched;
  const PointRequest request = request_beside_kink(t, {place, true, slopes_, options_.interpolates_outputs});
  if (request.distance == 0.0 && has_searched_to(options_.events, place)) {
    complete_slopes({*options_.events, integrator_, output_, options_});
    return_searched_point(*options_.events, searched, x, xdot);
  } else output_.evaluate(integrator_, request, options_, x, xdot);
  // Other outputs cost the same with either method.
  if (choice_.chosen == Method::automatic && !integrator_.stepper->state().interpolates_well) choice_.note_output();
}

}  // namespace sfdae::core
