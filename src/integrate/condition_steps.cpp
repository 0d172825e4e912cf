// Steps that end where conditions on x switch.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/condition_steps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Movement of E x, in tolerances, beyond that explained by slopes, half of a jump. (Chosen.)
constexpr double clear_move = 0.5;
// A zero is located when x and the condition move by less than this part of the tolerances across it. (Chosen:
// continuous positions stay continuous to this accuracy.)
constexpr double located = 1e-4;
// Distance of a condition for which tolerances give no error margin. Its zero is located when the interval reaches the
// rounding errors of t.
constexpr double farthest = 1e30;
// Minimum distance of both points, so that rounding errors of x do not undo the switch. (As near switching times of t.)
constexpr double roundings_of_gap = 32.0;
// If one condition switches more often than a cubic while E x moves by less than this many tolerances between changes
// of branches, there is no progress. (Chosen, as in hybrid systems.)
constexpr double no_progress = 10.0;
constexpr int most_visits = 3;
// Step-size factor if E x moves differently from the slopes while a condition that cannot be held switches. (Chosen, as
// after failures.)
constexpr double shorter_at_switch = 0.25;

bool has_switches(HeldConditions& conditions) {
  return conditions.count() > 0 || conditions.stepped_functions().count() > 0;
}

}  // namespace

void ConditionSteps::resize(HeldConditions* conditions, std::size_t n) {
  conditions_ = conditions != nullptr && has_switches(*conditions) ? conditions : nullptr;
  if (conditions_ == nullptr) return;
  movement_.resize(n);
  for (std::vector<double>* const each :
       {&slopes_, &slopes_before_, &change_, &tolerances_, &passed_.x, &obstacle_.x})
    each->resize(n);
  for (Attempt* const each : {&tried_, &before_, &after_}) {
    each->x.resize(n);
    each->g.resize(conditions_->count());
  }
  branches_.resize(conditions_->count());
  next_.g.resize(conditions_->count());
  passed_.visits.resize(conditions_->count());
  near_.is_near.assign(conditions_->count(), 0);
  near_.x.resize(n);
  near_.gradients.resize(conditions_->count() * conditions_->functions().width());
}

bool ConditionSteps::has_switched(const std::vector<double>& g) const {
  for (std::size_t k = 0; k < g.size(); ++k)
    if (is_met(g[k]) != is_met(branches_[k])) return true;
  return false;
}

// Slopes of the solution history at the last point; at the end of a step those of the equations, if they determine
// them.
void ConditionSteps::find_slopes(const Integrator& integrator, double t, const std::vector<double>& x,
                                 std::vector<double>& slopes) {
  const bool is_last = t == integrator.stepper->state().t;
  if (is_last || !integrator.system.exact_derivative(x.data(), slopes.data()))
    integrator.stepper->interpolate({t, nullptr, change_.data(), slopes.data()});
}

void ConditionSteps::evaluate(const Integrator& integrator, double t, const std::vector<double>& x,
                              std::vector<double>& g) {
  if (conditions_->functions().depend_on_derivatives()) find_slopes(integrator, t, x, slopes_);
  conditions_->functions().evaluate(t, x.data(), slopes_.data(), g.data());
}

void ConditionSteps::hold() {
  conditions_->hold(branches_.data());
  is_held_ = true;
  has_after_ = false;
}

void ConditionSteps::release() {
  conditions_->release();
  is_held_ = false;
}

// Finds the branches at the last point.
void ConditionSteps::find_branches(const Integrator& integrator) {
  const double t = integrator.stepper->state().t;
  if (!is_held_ && known_ != t) evaluate(integrator, t, integrator.stepper->x(), branches_);
  known_ = t;
}

void ConditionSteps::take_attempt(const Integrator& integrator) {
  const StepState state = integrator.stepper->state();
  find_branches(integrator);
  has_tried_ = true;
  tried_.t = state.tried_t;
  std::copy(integrator.stepper->tried_x().begin(), integrator.stepper->tried_x().end(), tried_.x.begin());
  evaluate(integrator, tried_.t, tried_.x, tried_.g);
}

bool ConditionSteps::explain_step(const Integrator& integrator) {
  if (conditions_ == nullptr || conditions_->count() == 0) return false;
  if (!is_held_) take_attempt(integrator);
  return is_held_ || has_switched(tried_.g);
}

bool ConditionSteps::may_jump(const Integrator& integrator, bool with_sensitivities) {
  const bool differentiates = integrator.system.differentiates();
  if (conditions_ == nullptr || conditions_->count() == 0 || !(differentiates || with_sensitivities)) return false;
  if (!has_switched(tried_.g)) return false;
  if (!differentiates || !conditions_->can_be_held()) return !are_kinks(integrator);
  return with_sensitivities || !moves_as_slopes_say(integrator);
}

// Hidden switches: conditions switch back within the step, and only residuals between its ends show their effect.
bool ConditionSteps::ends_between_switches(const Integrator& integrator) {
  if (conditions_ == nullptr || conditions_->count() == 0) return false;
  const QuietArithmetic quiet;
  take_attempt(integrator);
  const SwitchSearch& search = conditions_->search();
  const PointsOfCurve points = integrator.stepper->points_of_tried();
  find_tolerances(integrator, points.x[1]);
  for (double& tolerance : tolerances_) tolerance *= located;
  find_switches(points);
  find_sampled(points);
  const std::vector<double>& times = next_.times.empty() ? search.times_between() : next_.times;
  if (times.empty() && search.known_to() == points.t[1]) return false;
  const std::optional<double> hidden = first_hidden(points, times);
  if (!hidden && search.known_to() == points.t[1]) return false;
  const double h = points.t[1] - points.t[0];
  const double part = std::max(shorter_at_switch, (search.known_to() - points.t[0]) / h);
  const double end = hidden ? *hidden : points.t[0] + part * h;
  if (std::fabs(end - points.t[0]) >= Integrator::smallest_step(points.t[0], points.t[1])) {
    next_.end = end;
    has_after_ = false;
    return true;
  }
  if (hidden) return false;  // the interval is shorter than the resolution of times
  throw Failure(SFDAE_STEP_TOO_SMALL,
                format("at t = %.15g it cannot be known whether conditions on x switch: see the condition in %s.",
                       points.t[0], conditions_->equation_with(conditions_->searched()[0]).c_str()));
}

// Finds the switches within the step tried.
void ConditionSteps::find_switches(const PointsOfCurve& points) {
  SwitchSearch& search = conditions_->search();
  if (!is_held_ && conditions_->find_simple_switches(points, branches_.data(), tried_.g.data())) return;
  search.find(points, nullptr);
  if (search.known_to() == points.t[1]) return;
  // Rounding errors may decide: changes below the accuracy of x are ignored.
  const std::vector<double> changes =
      conditions_->functions().resolution(points.t[1], points.x[1], nullptr, tolerances_.data());
  std::vector<double> margins;
  for (const std::size_t k : conditions_->searched()) margins.push_back(changes[k]);
  search.find(points, margins.data());
}

// Adds places at which conditions that cannot be searched have other branches than at both ends: nothing is known of
// these conditions in between, so several places are looked at. Nothing is allocated if there are none.
void ConditionSteps::find_sampled(const PointsOfCurve& points) {
  constexpr int places = 8;  // within the step. (Chosen, as for sides of surfaces.)
  next_.times.clear();
  const std::vector<std::size_t>& searched = conditions_->searched();
  if (searched.size() == conditions_->count()) return;
  const auto differs = [&](std::size_t k) {
    const bool is_searched = std::binary_search(searched.begin(), searched.end(), k);
    const bool before = is_met(branches_[k]), after = is_met(tried_.g[k]);
    return !is_searched && before == after && is_met(next_.g[k]) != before;
  };
  for (int place = 1; place < places; ++place) {
    const double t = points.t[0] + place * (points.t[1] - points.t[0]) / places;
    points.evaluate(t, change_.size(), change_.data(), slopes_.data());
    conditions_->functions().evaluate(t, change_.data(), slopes_.data(), next_.g.data());
    bool any = false;
    for (std::size_t k = 0; k < next_.g.size(); ++k) any = any || differs(k);
    if (any) next_.times.push_back(t);
  }
  if (next_.times.empty()) return;
  const std::vector<double>& between = conditions_->search().times_between();
  next_.times.insert(next_.times.end(), between.begin(), between.end());
  const bool is_forward = points.t[1] > points.t[0];
  std::sort(next_.times.begin(), next_.times.end(), [&](double a, double b) { return is_forward ? a < b : b < a; });
}

// The first of these times at which the effect of branches on residuals is not visible at the end of the step.
std::optional<double> ConditionSteps::first_hidden(const PointsOfCurve& points, const std::vector<double>& times) {
  const std::size_t n = change_.size();
  std::vector<double> values(2 * n * (times.size() + 1));
  std::vector<HeldConditions::Point> between;
  for (std::size_t k = 0; k <= times.size(); ++k) {
    double* const x = values.data() + 2 * n * k;
    const double t = k < times.size() ? times[k] : points.t[1];
    points.evaluate(t, n, x, x + n);
    between.push_back({t, x, x + n});
  }
  const HeldConditions::Point to = between.back();
  between.pop_back();
  const std::optional<std::size_t> first =
      conditions_->first_hidden(branches_.data(), between, to, tolerances_.data());
  return first ? std::optional<double>(times[*first]) : std::nullopt;
}

// False if slopes are unknown.
bool ConditionSteps::moves_as_slopes_say(const Integrator& integrator) {
  return std::islessequal(movement_.unexplained(integrator), clear_move);
}

// True if residuals are continuous at the conditions that have switched.
bool ConditionSteps::are_kinks(const Integrator& integrator) {
  const QuietArithmetic quiet;
  const StepState state = integrator.stepper->state();
  find_slopes(integrator, state.t, integrator.stepper->x(), slopes_before_);
  find_slopes(integrator, tried_.t, tried_.x, slopes_);
  const HeldConditions::Point from{state.t, integrator.stepper->x().data(), slopes_before_.data()};
  const HeldConditions::Point to{tried_.t, tried_.x.data(), slopes_.data()};
  for (std::size_t k = 0; k < branches_.size(); ++k)
    if (is_met(tried_.g[k]) != is_met(branches_[k]) &&
        conditions_->passing(k, branches_.data(), from, to) == HeldConditions::Passing::jump)
      return false;
  return true;
}

// If a condition that cannot be held switches, steps become shorter until slopes explain the movement of E x, or E x is
// found to jump.
bool ConditionSteps::steps_with_jump(const Integrator& integrator) {
  if (conditions_ == nullptr || conditions_->stepped_functions().count() == 0) return false;
  if (is_held_ || !integrator.system.differentiates() || !conditions_->can_be_held()) return false;
  const StepState state = integrator.stepper->state();
  tried_.t = state.tried_t;
  std::copy(integrator.stepper->tried_x().begin(), integrator.stepper->tried_x().end(), tried_.x.begin());
  if (conditions_->stepped_functions().depend_on_derivatives()) {
    find_slopes(integrator, state.t, integrator.stepper->x(), slopes_before_);
    find_slopes(integrator, tried_.t, tried_.x, slopes_);
  }
  const auto found = conditions_->stepped_switch({state.t, integrator.stepper->x().data(), slopes_before_.data()},
                                                 {tried_.t, tried_.x.data(), slopes_.data()});
  if (!found || moves_as_slopes_say(integrator)) return false;
  const double h = state.tried_t - state.t;
  if (std::fabs(h) < Integrator::smallest_step(state.t, state.tried_t) / shorter_at_switch)
    throw Failure(SFDAE_STEP_TOO_SMALL,
                  format("at t = %.15g a table, floor or remainder of x switches, and unknowns whose derivatives are "
                         "needed jump: see %s. Write it with conditions (choose), or stop there by an event.",
                         state.t, conditions_->equation_with_stepped(*found).c_str()));
  next_.end = state.t + shorter_at_switch * h;
  return true;
}

ConditionSteps::Verdict ConditionSteps::judge(const Integrator& integrator, bool with_sensitivities) {
  is_last_ = has_tried_ = false;
  if (conditions_ == nullptr) return Verdict::accepted;
  if (ends_between_switches(integrator)) return Verdict::again;
  if (!is_held_ && !may_jump(integrator, with_sensitivities)) return Verdict::accepted;
  // The equations before the zero advance sensitivities across it.
  if (with_sensitivities && !conditions_->can_be_held())
    obstacle_.lacks_branches = has_switched(tried_.g) && !are_kinks(integrator);
  if (is_held_) return locate(integrator);
  hold();
  next_.end = tried_.t;
  return Verdict::again;
}

// Both ends of an interval that contains a zero, which starts at the last point, approach it until x hardly moves
// between them. The step ends at the first of them, and the jump leads to the other.
ConditionSteps::Verdict ConditionSteps::locate(const Integrator& integrator) {
  const double start = integrator.stepper->state().t;
  // An attempt at one of the ends, or beyond the last, counts as before, whatever rounding errors do.
  const bool is_final = has_after_ && tried_.t == before_.t;
  const bool is_beyond = has_after_ && std::fabs(tried_.t - start) >= std::fabs(after_.t - start);
  const bool is_after = !is_final && (is_beyond || has_switched(tried_.g));
  // No condition has switched in an attempt that had to be shorter for other reasons, such as inputs.
  const bool is_shorter = next_.end && tried_.t != *next_.end;
  if (!is_after && (!has_after_ || is_shorter)) return Verdict::accepted;
  const double width = has_after_ ? std::fabs(after_.t - before_.t) : 0.0;
  if (!has_after_) {
    before_.t = start;
    std::copy(integrator.stepper->x().begin(), integrator.stepper->x().end(), before_.x.begin());
    evaluate(integrator, before_.t, before_.x, before_.g);
    next_.slow = 0;
  }
  std::swap(is_after ? after_ : before_, tried_);
  has_after_ = true;
  const double now = std::fabs(after_.t - before_.t), apart = distance(integrator);
  next_.slow = width > 0.0 && now > 0.5 * width ? next_.slow + 1 : 0;
  const double least = roundings_of_gap * Integrator::resolution(before_.t, after_.t);
  is_last_ = apart <= located || now <= 2.0 * least;
  if (is_last_ && now < 0.5 * least) {
    next_.end = before_.t + std::copysign(least, after_.t - before_.t);
    is_last_ = false;
    return Verdict::again;
  }
  if (is_last_ && before_.t == start) {
    is_due_ = true;
    has_after_ = false;
    next_.end.reset();
    return Verdict::again;
  }
  if (is_last_ && !is_after) return Verdict::accepted;
  next_.end = is_last_ ? before_.t : next_end(integrator, apart);
  is_last_ = false;
  return Verdict::again;
}

// Distance of x, or of the conditions that switch, between both points, in tolerances: x may stay where it is until a
// branch changes; then g shows how late that is.
double ConditionSteps::distance(const Integrator& integrator) {
  for (std::size_t i = 0; i < change_.size(); ++i) change_[i] = after_.x[i] - before_.x[i];
  double result = integrator.weights.norm(change_.data());
  find_tolerances(integrator, after_.x.data());
  const std::vector<double> open =
      conditions_->functions().resolution(after_.t, after_.x.data(), slopes_.data(), tolerances_.data());
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    if (is_met(after_.g[k]) == is_met(branches_[k])) continue;
    const double moved = std::fabs(after_.g[k] - before_.g[k]);
    result = std::max(result, moved < farthest * open[k] ? moved / open[k] : farthest);
  }
  return result;
}

// Next point: the first zero if the conditions are linear, shifted so far from it that the interval also becomes small
// if they are not; the middle if progress is slow. distance: between both ends, see distance().
double ConditionSteps::next_end(const Integrator& integrator, double distance) {
  const double a = before_.t, b = after_.t, middle = 0.5 * (a + b);
  if (next_.slow >= 2 || !std::isfinite(distance)) return middle;
  double part = 1.0;
  const double least = roundings_of_gap * Integrator::resolution(a, b) / std::fabs(b - a);
  const double enough = std::min(0.5, std::max(0.5 * located / distance, least));
  // Beyond the zero first, then before it, so close that x hardly moves in between.
  const auto end_at = [&](double at_zero) {
    const double beside = 0.8 * enough;
    const double part = 1.0 - at_zero > 2.0 * beside ? at_zero + beside : at_zero - beside;
    return a + std::clamp(part, enough, 1.0 - enough) * (b - a);
  };
  // At first the polynomial of the step is more accurate.
  if (a == integrator.stepper->state().t && conditions_->search().first_switch()) {
    const double at_zero = (*conditions_->search().first_switch() - a) / (b - a);
    if (at_zero > 0.0 && at_zero < 1.0) return end_at(at_zero);
  }
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const double at_a = before_.g[k], at_b = after_.g[k];
    if (is_met(at_b) == is_met(branches_[k])) continue;
    const double at_zero = at_a / (at_a - at_b);
    part = std::min(part, std::isfinite(at_zero) ? std::clamp(at_zero, 0.0, 1.0) : 0.5);
  }
  return end_at(part);
}

// True if conditions differ at the end of a failed step and residuals jump there; if the step has no solution, true if
// the extrapolated polynomial predicts other conditions.
bool ConditionSteps::switches_ahead(const Integrator& integrator, StepOutcome outcome) {
  if (outcome == StepOutcome::error_too_large) {
    take_attempt(integrator);
    return has_switched(tried_.g) && !are_kinks(integrator);
  }
  find_branches(integrator);
  const double t = integrator.stepper->state().tried_t;
  integrator.stepper->interpolate({t, nullptr, change_.data(), slopes_.data()});
  conditions_->functions().evaluate(t, change_.data(), slopes_.data(), tried_.g.data());
  return has_switched(tried_.g);
}

// Counts steps that fail without a solution although branches cannot be held. A few occur at kinks, too, and shorter
// steps succeed there.
void ConditionSteps::note_obstacle(const Integrator& integrator) {
  if (obstacle_.failures == 0 || !is_idle(integrator, obstacle_.x)) {
    obstacle_.failures = 0;
    obstacle_.x = integrator.stepper->x();
  }
  obstacle_.lacks_branches = ++obstacle_.failures > most_visits;
}

// True if the next attempt, with the branches held, has the same length: a condition switches ahead, and E x jumps, or
// the equations end where a branch does. If that attempt fails, too, a shorter one has free branches. Branches stay
// next to the last zero passed. Kinks that were passed repeatedly are crossed.
bool ConditionSteps::is_tried_with_branches_held(const Integrator& integrator, StepOutcome outcome) {
  if (conditions_ == nullptr) return false;
  next_.end.reset();
  has_after_ = false;
  if (conditions_->count() == 0 || is_due_) return false;
  if (is_held_) {
    evaluate(integrator, integrator.stepper->state().t, integrator.stepper->x(), tried_.g);
    if (!has_switched(tried_.g)) release();
    return false;
  }
  const QuietArithmetic quiet;
  const bool switches = switches_ahead(integrator, outcome);
  const bool has_end = outcome == StepOutcome::error_too_large;
  if (passed_.are_kinks && stays_at_passed(integrator)) return false;
  passed_.are_kinks = false;
  // The error test has failed for another reason.
  if (has_end && !integrator.system.differentiates() && !switches) return false;
  hold();
  if (conditions_->can_be_held()) return switches;
  if (switches && !has_end) note_obstacle(integrator);
  return false;
}

// Conditions at a zero that is due are reported by changed() instead.
std::vector<PassedSwitch> ConditionSteps::passed() const {
  if (conditions_ == nullptr || !has_tried_ || is_last_) return {};
  return conditions_->passed({known_, branches_}, {tried_.t, tried_.g});
}

void ConditionSteps::commit(const Integrator& integrator) {
  if (conditions_ == nullptr) return;
  const bool is_visited =
      std::any_of(passed_.visits.begin(), passed_.visits.end(), [](int visits) { return visits > 0; });
  if (!passed_.has_moved && (is_visited || passed_.are_kinks)) passed_.has_moved = !is_idle(integrator, passed_.x);
  next_.end.reset();
  has_after_ = false;
  is_due_ = is_last_;
  if (is_held_ && !is_due_) release();
  known_ = std::numeric_limits<double>::quiet_NaN();
  if (!has_tried_ || is_due_) return;
  branches_ = tried_.g;
  known_ = tried_.t;
}

void ConditionSteps::find_tolerances(const Integrator& integrator, const double* x) {
  for (std::size_t i = 0; i < tolerances_.size(); ++i)
    tolerances_[i] = integrator.weights.tolerance(static_cast<int>(i), x);
}

// True if E x has hardly moved since it had these values; sets tolerances_ to those at the last point.
bool ConditionSteps::is_idle(const Integrator& integrator, const std::vector<double>& before) {
  const std::vector<double>& x = integrator.stepper->x();
  for (std::size_t i = 0; i < x.size(); ++i) change_[i] = x[i] - before[i];
  find_tolerances(integrator, x.data());
  return integrator.system.change_of_differentiated(change_.data(), tolerances_.data()) <= no_progress;
}

// x may return to its earlier value after having been elsewhere.
bool ConditionSteps::stays_at_passed(const Integrator& integrator) {
  return is_idle(integrator, passed_.x) && !passed_.has_moved;
}

// The first condition whose value clearly contradicts its branch; the number of conditions if there is none.
std::size_t ConditionSteps::contradiction(const Integrator& integrator, const ConsistentPoint& after,
                                          const std::vector<double>& branches) {
  find_tolerances(integrator, after.x.data());
  conditions_->functions().evaluate(after.t, after.x.data(), after.xdot.data(), tried_.g.data());
  const std::vector<double> clear =
      conditions_->functions().resolution(after.t, after.x.data(), after.xdot.data(), tolerances_.data());
  for (std::size_t k = 0; k < branches.size(); ++k)
    if (is_met(tried_.g[k]) != is_met(branches[k]) && std::fabs(tried_.g[k]) > clear[k]) return k;
  return branches.size();
}

// True if residuals jump where condition k, which is near zero, crosses zero.
bool ConditionSteps::jumps_at_zero(const Integrator& integrator, std::size_t k) {
  const double t = integrator.stepper->state().t;
  const std::vector<double>& x = integrator.stepper->x();
  find_slopes(integrator, t, x, slopes_);
  double steepness = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double slope = near_.gradients[i * branches_.size() + k] * tolerances_[i];
    steepness += slope * slope;
  }
  // The point on the other side of the zero, at the same distance.
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double slope = near_.gradients[i * branches_.size() + k];
    change_[i] = x[i] - 2.0 * tried_.g[k] / steepness * slope * tolerances_[i] * tolerances_[i];
  }
  const HeldConditions::Point from{t, x.data(), slopes_.data()}, to{t, change_.data(), slopes_.data()};
  return conditions_->passing(k, tried_.g.data(), from, to) == HeldConditions::Passing::jump;
}

void ConditionSteps::demand_distinct(const Integrator& integrator) {
  constexpr double near = 0.1;  // relative to the width of layers, which is due to the tolerances
  SlidingLayers* const layers = conditions_ != nullptr ? conditions_->layers() : nullptr;
  if (layers == nullptr || !layers->are_entered() || is_due_)
    return std::fill(near_.is_near.begin(), near_.is_near.end(), 0);
  const QuietArithmetic quiet;
  const double t = integrator.stepper->state().t;
  const std::vector<double>& x = integrator.stepper->x();
  ConditionFunctions& functions = conditions_->functions();
  if (functions.depend_on_derivatives()) find_slopes(integrator, t, x, slopes_);
  const double* const slopes = functions.depend_on_derivatives() ? slopes_.data() : nullptr;
  if (!functions.linearize(t, x.data(), slopes, tried_.g.data(), near_.gradients.data())) return;
  const bool stays = is_idle(integrator, near_.x);
  bool is_any_near = false;
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    const double open =
        functions.widths(near_.gradients.data() + k, branches_.size(), x.data(), tolerances_.data()).largest;
    const bool is_near = !conditions_->is_of_layer(k) && std::fabs(tried_.g[k]) < near * open;
    if (is_near && near_.is_near[k] != 0 && !stays && jumps_at_zero(integrator, k))
      throw Failure(
          SFDAE_ZENO,
          format("at t = %.15g x moves along the zero of one condition, and another one stays as near to its "
                 "zero as the tolerances are: what it does cannot be known. See the condition in %s.",
                 t, conditions_->equation_with(k).c_str()));
    near_.is_near[k] = is_near ? 1 : 0;
    is_any_near = is_any_near || is_near;
  }
  if (!is_any_near || !stays) near_.x = x;
}

void ConditionSteps::demand_progress(const Integrator& integrator) {
  const std::vector<double>& x = integrator.stepper->x();
  const bool stays = stays_at_passed(integrator);
  bool is_visited = false;
  passed_.sliding.clear();
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    if (!stays) passed_.visits[k] = 0;
    // At the edges of layers equations are continuous and do not lead back repeatedly.
    if (is_met(after_.g[k]) != is_met(branches_[k]) && !conditions_->is_of_layer(k)) ++passed_.visits[k];
    is_visited = is_visited || passed_.visits[k] > most_visits;
  }
  if (!is_visited) return;
  const double t = integrator.stepper->state().t;
  find_slopes(integrator, t, x, slopes_);
  // At a zero with continuous residuals nothing leads back.
  const HeldConditions::Point before{before_.t, before_.x.data(), slopes_.data()};
  const HeldConditions::Point after{after_.t, after_.x.data(), slopes_.data()};
  std::size_t named = 0;
  std::vector<std::size_t> sliding;
  for (std::size_t k = 0; k < branches_.size(); ++k) {
    if (passed_.visits[k] <= most_visits) continue;
    named = k;
    const bool is_switched = is_met(after_.g[k]) != is_met(branches_[k]);
    if (!is_switched || conditions_->passing(k, branches_.data(), before, after) != HeldConditions::Passing::kink)
      sliding.push_back(k);
  }
  if (sliding.empty()) {
    std::fill(passed_.visits.begin(), passed_.visits.end(), 0);
    passed_.are_kinks = true;
    return;
  }
  passed_.sliding = conditions_->functions().surfaces(sliding, {t, x.data(), slopes_.data()}, tolerances_.data());
  throw Failure(SFDAE_ZENO,
                format("at t = %.15g conditions switch again and again while x stays where it is: both sides of one "
                       "of them lead toward each other. See the condition in %s.",
                       t, conditions_->equation_with(named).c_str()));
}

std::vector<double> ConditionSteps::shifts(const ConsistentPoint& at, ConstView S,
                                           const std::vector<int>& parameters) {
  if (conditions_->functions().depend_on_derivatives())
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("at t = %.15g a condition on x' switches; with sensitivities conditions have to be on t and "
                         "x. Make x' an unknown.",
                         at.t));
  std::vector<std::size_t> switched;
  for (std::size_t k = 0; k < branches_.size(); ++k)
    if (is_met(after_.g[k]) != is_met(branches_[k])) switched.push_back(k);
  const auto found = conditions_->functions().shifts(switched, {at.t, at.x.data(), at.xdot.data()}, S, parameters);
  if (found) return *found;
  throw Failure(SFDAE_SINGULAR,
                format("at t = %.15g a condition only touches zero, or several switch whose times move "
                       "differently: sensitivities after that do not exist. See the condition in %s.",
                       at.t, conditions_->equation_with(switched[0]).c_str()));
}

ConsistentPoint ConditionSteps::change_branches(const Integrator& integrator,
                                                const std::function<ConsistentPoint()>& values_after) {
  demand_progress(integrator);
  std::vector<double> branches = after_.g;
  std::size_t k = 0;
  for (std::size_t round = 0; round <= branches.size(); ++round) {
    for (double& branch : branches) branch = is_met(branch) ? 1.0 : -1.0;
    conditions_->hold(branches.data());
    ConsistentPoint after = values_after();
    k = contradiction(integrator, after, branches);
    if (k == branches.size()) {
      passed_.branches = std::move(branches);
      return after;
    }
    branches[k] = -branches[k];
  }
  throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                format("at t = %.15g conditions switch, and no branches of theirs agree with the values that they "
                       "lead to: see the condition in %s.",
                       after_.t, conditions_->equation_with(k).c_str()));
}

std::vector<PassedSwitch> ConditionSteps::changed() const {
  return conditions_->passed({before_.t, branches_}, {after_.t, passed_.branches});
}

void ConditionSteps::start_after_change(const std::vector<double>& x) {
  branches_ = passed_.branches;
  is_due_ = false;
  passed_.from = before_.t;
  passed_.to = after_.t;
  passed_.x = x;
  passed_.has_moved = false;
  start();
}

void ConditionSteps::restore_branches() {
  if (conditions_ == nullptr) return;
  if (is_held_) conditions_->hold(branches_.data());
  else conditions_->release();
}

void ConditionSteps::archive(Archive& archive) {
  archive.small(is_due_, passed_.has_moved, passed_.are_kinks);
  archive.reals(branches_, branches_.size());
  for (double* const time : {&before_.t, &after_.t, &passed_.from, &passed_.to}) archive.real(*time);
  archive.reals(after_.x, after_.x.size());
  archive.reals(after_.g, after_.g.size());
  archive.reals(passed_.x, passed_.x.size());
  archive.small(passed_.visits.data(), passed_.visits.size());
  if (!archive.is_reading()) return;
  hold();
}

}  // namespace sfdae::core
