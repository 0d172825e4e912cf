// Jumps of the solution at jumps of data, in the driver of the integration.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "integrate/integration.h"
#include "integrate/integration_results.h"
#include "integrate/jump_rule.h"
#include "integrate/sensitivities.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// As negligible_jump, at the zero of a condition on x, which is known less accurately. (Chosen.)
constexpr double negligible_jump_at_zero = 0.1;

}  // namespace

// x += h xdot; true if the change is significant.
bool Integration::move(std::vector<double>& x, double h, const std::vector<double>& xdot) {
  constexpr double much = 0.1;  // of the tolerances
  std::vector<double> change(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += change[i] = h * xdot[i];
  integrator_.weights.update(x.data());
  return integrator_.weights.norm(change.data()) > much;
}

// From a point in the gap. Nothing is evaluated beyond the stop time.
void Integration::cross_gap(double tout, bool is_large) {
  TimeBreakpoints::Gap gap = *options_.breakpoints->gap_at(integrator_.stepper->state().t);
  const double direction = integrator_.direction;
  double& end = direction > 0.0 ? gap.end : gap.start;
  if (options_.stop_time && (end - *options_.stop_time) * direction > 0.0) end = *options_.stop_time;
  gap.is_jump = gap.is_jump || is_large;
  cross_jump(gap, tout);
}

// The last point before x or x' jumps, and the derivatives of the time of the jump by the parameters.
struct Integration::MovingSwitch {
  const ConsistentPoint& before;
  double toward;
  std::vector<double> shifts;
};

// True if x' jumps in a gap at a time that depends on parameters: then sensitivities jump.
bool Integration::moves_with_parameters(double h) {
  constexpr double far_enough =
      1e-3;  // of the interval of interest: residuals have their usual sizes there. (Chosen.)
  if (!companion_ || options_.conditions == nullptr) return false;
  const double t = integrator_.stepper->state().t;
  if (options_.conditions->timed_switches(t, t + h).empty()) return false;
  const double earlier = t - integrator_.direction * std::min(std::fabs(t - start_), far_enough * span_);
  return integrator_.system.differentiates() ||
         options_.conditions->jumps_between(t, t + h, earlier, integrator_.stepper->x().data());
}

// dt/dp of a switching time of t, which must be the same for all conditions that switch there.
std::vector<double> Integration::shifts_of_time(double to, const ConsistentPoint& before) {
  const std::vector<int>& parameters = sensitivities()->parameters();
  HeldConditions* const conditions = options_.conditions;
  if (conditions == nullptr) return std::vector<double>(parameters.size(), 0.0);
  const auto found = conditions->timed_functions().shifts(conditions->timed_switches(before.t, to),
                                                          {before.t, before.x.data(), before.xdot.data()},
                                                          sensitivities()->columns(), parameters);
  if (found) return *found;
  throw Failure(SFDAE_SINGULAR,
                format("at t = %.15g conditions on t switch whose times move differently with a parameter: "
                       "sensitivities after that do not exist.",
                       before.t));
}

// [GFB99] S. Galan, W. F. Feehery, P. I. Barton: Parametric sensitivity functions for hybrid discrete/continuous
//         systems. Appl. Numer. Math. 31 (1999), 17-47.
std::vector<double> Integration::sensitivities_after(const MovingSwitch& moving, const ConsistentPoint& after) {
  const Sensitivities& carried = *sensitivities();
  const int n = carried.unknowns(), count = carried.count();
  std::vector<double> moved = carried.last();
  const auto add = [&](std::vector<double>& S, double sign, const std::vector<double>& xdot) {
    for (std::size_t j = 0; j < index(count); ++j)
      for (std::size_t i = 0; i < index(n); ++i) S[j * index(n) + i] += sign * xdot[i] * moving.shifts[j];
  };
  add(moved, 1.0, moving.before.xdot);
  std::vector<double> result(moved.size());
  const MovingJump jump{after.t,
                        moving.toward,
                        moving.before.x.data(),
                        after.x.data(),
                        carried.parameters(),
                        moving.shifts.data(),
                        ConstView{moved.data(), n, count, n}};
  if (!options_.jumps->differentiate(jump, View{result.data(), n, count, n})) throw_jump_with_sensitivities(after.t);
  add(result, -1.0, after.xdot);
  return result;
}

ConsistentPoint Integration::values_with_branches(const PointOfInterest& before, double none) {
  const auto tolerance = [this](int i, const double* x) { return integrator_.weights.tolerance(i, x); };
  return options_.jumps->values(before, integrator_.system, tolerance, none);
}

// An exception leaves the point before the jump the last one.
void Integration::cross_jump(const TimeBreakpoints::Gap& gap, double tout) {
  const double direction = integrator_.direction, t = gap.far_end(direction);
  const double start = integrator_.stepper->state().t, half = 0.5 * (t - start);
  if (adjoint() != nullptr) throw_jump_with_sensitivities(start);
  const double toward = (tout - t) * direction > 0.0 ? tout : time_beside(t, direction);
  std::vector<double> before(integrator_.stepper->x().size()), slopes(before);
  integrator_.stepper->interpolate({start, nullptr, before.data(), slopes.data()});
  before = integrator_.stepper->x();
  std::optional<ConsistentPoint> point;
  if (companion_) point = options_.jumps->values_before({start, toward, integrator_.stepper->x().data()});
  // Extrapolates across both halves of the gap by the slopes; those after the gap require the values at its end.
  const bool moves = move(before, half, slopes);
  const auto values = [&] {
    const PointOfInterest place{t, toward, before.data()};
    return gap.is_jump ? options_.jumps->values_after(place) : values_with_branches(place, negligible_jump);
  };
  ConsistentPoint after = values();
  if (move(before, half, after.xdot) || moves) after = values();
  if (point) {
    std::vector<double> shifts = shifts_of_time(t, *point);
    point->x = before;
    const MovingSwitch moving{*point, toward, std::move(shifts)};
    go_on_after_jump(t, after, &moving);
  } else {
    go_on_after_jump(t, after, nullptr);
  }
  if (options_.breakpoints != nullptr)
    switches_.note(options_.breakpoints->passed(start, t), is_jump(before, after.x));
  record_gap(start, t, after.x);
}

// True if E x has changed.
bool Integration::is_jump(const std::vector<double>& before, const std::vector<double>& after) {
  constexpr double clear = 1.0;  // tolerances. (Chosen.)
  std::vector<double> change(before.size());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] = after[i] - before[i];
  return !(integrator_.system.change_of_differentiated(change.data(), layer_point().tolerances) <= clear);
}

// The last point is unchanged if sensitivities after the jump do not exist, or a start there fails.
void Integration::go_on_after_jump(double t, const ConsistentPoint& after, const MovingSwitch* moving) {
  std::vector<double> S;
  if (moving != nullptr) S = sensitivities_after(*moving, after);
  resize_workspace();
  integrator_.start(t, after.x, after.xdot, options_);
  if (conditions_.is_due()) conditions_.start_after_change(after.x);
  else conditions_.start();
  if (moving != nullptr) dynamic_cast<Sensitivities&>(*companion_).replace_last(std::move(S));
  integrator_.must_restart = companion_ != nullptr;  // restart again if that fails
  if (companion_) companion_->start(integrator_);
  integrator_.must_restart = false;
  approach_.reset();
  if (watch_) watch_->start(integrator_.direction);
  start_trail();
}

// A condition on x is zero between the last point and one next to it. An exception leaves the last point and its
// branches unchanged.
void Integration::change_branches(double tout) {
  const double start = integrator_.stepper->state().t, t = conditions_.t_after();
  const double toward = (tout - t) * integrator_.direction > 0.0 ? tout : time_beside(t, integrator_.direction);
  const PointOfInterest place{t, toward, conditions_.x_after().data()};
  std::optional<ConsistentPoint> before;
  std::vector<double> shifts;
  if (companion_) {
    before = options_.jumps->values_before(place);
    shifts = conditions_.shifts(*before, sensitivities()->columns(), sensitivities()->parameters());
  }
  try {
    const ConsistentPoint after = conditions_.change_branches(
        integrator_, [&] { return values_with_branches(place, negligible_jump_at_zero); });
    std::vector<PassedSwitch> changed = conditions_.changed();
    const bool jumps = is_jump(conditions_.x_after(), after.x);
    std::optional<MovingSwitch> moving;
    if (before) moving.emplace(MovingSwitch{*before, toward, std::move(shifts)});
    go_on_after_jump(t, after, moving ? &*moving : nullptr);
    switches_.note(std::move(changed), jumps);
    record_gap(start, t, after.x);
  } catch (...) {
    conditions_.restore_branches();
    throw;
  }
}

void Integration::continue_from(Integration& before, double longest) {
  if (is_jump(before.integrator_.stepper->x(), integrator_.stepper->x()))
    throw Failure(SFDAE_NO_CONSISTENT_VALUES, "consistent values of these equations have another E x.");
  const double step = integrator_.stepper->state().next_step;
  if (std::fabs(step) > longest) integrator_.stepper->set_next_step(std::copysign(longest, step));
  take_past(before);
}

void Integration::take_past(Integration& before) {
  counts_.restore(before.counts(), integrator_.system);
  integrator_.contradictions.largest = before.integrator_.contradictions.largest;
  choice_ = before.choice_;
  start_ = before.start_;
  span_ = before.span_;
  inputs_.take_account(before.inputs_);
  slopes_ = before.slopes_;
  branches_.passed = before.branches_.passed;
  switches_ = std::move(before.switches_);
  recording_.solution = std::move(before.recording_.solution);
}

// Within the gap, which starts there, the recorded values are those after it.
void Integration::record_gap(double from, double to, const std::vector<double>& after) {
  const std::shared_ptr<SolutionPieces> solution = recording_.solution.lock();
  if (!solution) return;
  const auto sample = [&](double, double* x) {
    std::copy(after.begin(), after.end(), x);
    return true;
  };
  const bool continues = std::exchange(recording_.is_on, false);
  add_piece(*solution, {from, to, continues, sample, {}});
}

}  // namespace sfdae::core
