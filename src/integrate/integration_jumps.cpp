// Jumps of the solution where data jump, in the driver of the integration.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <utility>

#include "integrate/integration.h"
#include "integrate/integration_results.h"
#include "integrate/jump_rule.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

// x += h xdot; true: by more than what does not matter.
bool Integration::move(std::vector<double>& x, double h, const std::vector<double>& xdot) {
  constexpr double much = 0.1;  // of the tolerances
  std::vector<double> change(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += change[i] = h * xdot[i];
  integrator_.weights.update(x.data());
  return integrator_.weights.norm(change.data()) > much;
}

// From a point in it. Nothing is evaluated beyond the stop time.
void Integration::cross_gap(double tout) {
  TimeBreakpoints::Gap gap = *options_.breakpoints->gap_at(integrator_.stepper->state().t);
  const double direction = integrator_.direction;
  double& end = direction > 0.0 ? gap.end : gap.start;
  if (options_.stop_time && (end - *options_.stop_time) * direction > 0.0) end = *options_.stop_time;
  cross_jump(gap, tout);
}

// The point before stays the last one where that throws.
void Integration::cross_jump(const TimeBreakpoints::Gap& gap, double tout) {
  const double direction = integrator_.direction, t = gap.far_end(direction);
  if (companion_) throw_jump_with_sensitivities(integrator_.stepper->state().t);
  const double toward = (tout - t) * direction > 0.0 ? tout : time_beside(t, direction);
  std::vector<double> before(integrator_.stepper->x().size()), slopes(before);
  const double start = integrator_.stepper->state().t, half = 0.5 * (t - start);
  integrator_.stepper->interpolate({start, nullptr, before.data(), slopes.data()});
  before = integrator_.stepper->x();
  const auto values_after = [&] { return options_.jumps->values_after({t, toward, before.data()}); };
  // Both halves of the gap as far as slopes lead: those after it are known when its end is.
  const bool moves = move(before, half, slopes);
  ConsistentPoint after = values_after();
  if (move(before, half, after.xdot) || moves) after = values_after();
  go_on_after_jump(t, after);
  record_gap(start, t, after.x);
}

void Integration::go_on_after_jump(double t, const ConsistentPoint& after) {
  resize_workspace();
  integrator_.start(t, after.x, after.xdot, options_);
  integrator_.must_restart = false;
  conditions_.start();
  approach_.reset();
  if (watch_) watch_->start(integrator_.direction);
  start_trail();
}

// At the last point a condition on x is zero. It stays the last one where that throws.
void Integration::change_branches(double tout) {
  const double t = integrator_.stepper->state().t;
  const std::vector<double> before = integrator_.stepper->x();
  const PointOfInterest point{t, integrator_.has_passed(tout) ? time_beside(t, integrator_.direction) : tout,
                              before.data()};
  const ConsistentPoint after =
      conditions_.change_branches(integrator_, [&] { return options_.jumps->values_after(point); });
  go_on_after_jump(t, after);
  is_recorded_ = false;
}

// Within the gap, which begins there, the values are those after it.
void Integration::record_gap(double from, double to, const std::vector<double>& after) {
  const std::shared_ptr<SolutionPieces> solution = solution_.lock();
  if (!solution) return;
  const auto sample = [&](double, double* x) {
    std::copy(after.begin(), after.end(), x);
    return true;
  };
  const bool continues = std::exchange(is_recorded_, false);
  add_piece(*solution, {from, to, continues, sample, {}});
}

}  // namespace sfdae::core
