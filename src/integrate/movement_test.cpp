// Test whether E x has moved in a step according to its slopes.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/movement_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sfdae::core {

void MovementTest::resize(std::size_t n) {
  for (std::vector<double>* const each : {&change_, &x_, &slopes_, &tolerances_}) each->resize(n);
}

// Sets the slopes of the polynomial of the step.
void MovementTest::set_slopes(const Integrator& integrator, double t) {
  integrator.stepper->points_of_tried().evaluate(t, x_.size(), x_.data(), slopes_.data());
}

void MovementTest::add(double factor) {
  for (std::size_t i = 0; i < change_.size(); ++i) change_[i] += factor * slopes_[i];
}

double MovementTest::size(const Integrator& integrator) {
  for (std::size_t i = 0; i < change_.size(); ++i)
    tolerances_[i] = integrator.weights.tolerance(static_cast<int>(i), integrator.stepper->tried_x().data());
  return integrator.system.change_of_differentiated(change_.data(), tolerances_.data());
}

// Starts with half of h times the difference of the slopes at the start.
void MovementTest::add_change_at_start(const Integrator& integrator) {
  const StepState state = integrator.stepper->state();
  const double half = 0.5 * (state.tried_t - state.t);
  std::fill(change_.begin(), change_.end(), 0.0);
  set_slopes(integrator, state.t);
  add(half);
  integrator.stepper->interpolate({state.t, nullptr, x_.data(), slopes_.data()});
  add(-half);
}

double MovementTest::unexplained_at_start(const Integrator& integrator) {
  add_change_at_start(integrator);
  return size(integrator) / std::fabs(integrator.stepper->points_of_tried().part_of_second_in_slope());
}

double MovementTest::unexplained(const Integrator& integrator) {
  const StepState state = integrator.stepper->state();
  const double half = 0.5 * (state.tried_t - state.t);
  add_change_at_start(integrator);
  set_slopes(integrator, state.tried_t);
  add(half);
  if (!integrator.system.exact_derivative(integrator.stepper->tried_x().data(), slopes_.data()))
    return std::numeric_limits<double>::infinity();
  add(-half);
  return size(integrator);
}

}  // namespace sfdae::core
