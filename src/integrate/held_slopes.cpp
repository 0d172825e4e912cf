// Slopes of w at other times than the present one, with w held.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/held_slopes.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Minimum length of a stride relative to the total time difference.
constexpr double least_stride = 0.01;
constexpr int most_strides = 12;

}  // namespace

void HeldSlopes::resize(const DaeSystem& system) {
  const std::size_t n = index(system.unknowns());
  w_.assign(std::max(n, index(system.leading_size())), 0.0);
  for (std::vector<double>* v : {&x_, &xdot_, &from_}) v->assign(n, 0.0);
  const std::size_t columns = system.taylor_order() > 0 ? index(system.taylor_order() + 1) : 2;
  for (std::vector<double>* v : {&taylor_, &taylor_before_}) v->assign(n * columns, 0.0);
}

bool HeldSlopes::find(Integrator& integrator, double t, std::vector<double>& wdot) {
  DaeSystem& system = integrator.system;
  const double start = integrator.stepper->state().t;
  integrator.stepper->interpolate({start, w_.data(), x_.data(), xdot_.data()});
  try {
    // The start itself is consistent.
    if (t == start ? system.move_to(t) != PointStatus::ok : !follow(integrator, t)) return false;
    if (!system.estimate_derivative(x_.data(), xdot_.data()) || !all_finite(xdot_.data(), xdot_.size())) return false;
    system.leading_derivative(x_.data(), xdot_.data(), wdot.data());
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return false;
  }
  return all_finite(wdot.data(), wdot.size());
}

// Moves x to t from the start with w held; if the equations are too nonlinear for one stride, via times in between.
bool HeldSlopes::follow(Integrator& integrator, double t) {
  const double start = integrator.stepper->state().t;
  double at = start, stride = t - start;
  from_ = integrator.stepper->x();
  for (int tries = 0; tries < most_strides && std::fabs(stride) > least_stride * std::fabs(t - start); ++tries) {
    const double next = std::fabs(t - at) <= std::fabs(stride) ? t : at + stride;
    if (!restore(integrator, next)) {
      stride *= 0.25;
      continue;
    }
    if (next == t) return true;
    at = next;
    from_ = x_;
    stride *= 2.0;
  }
  return false;
}

// x at t from from_, which is nearby.
bool HeldSlopes::restore(Integrator& integrator, double t) {
  DaeSystem& system = integrator.system;
  const std::size_t n = x_.size();
  Guess guess;
  if (system.taylor_order() > 0) {
    std::fill(taylor_.begin(), taylor_.end(), 0.0);
    std::copy(from_.begin(), from_.end(), taylor_.begin());
    std::copy_n(xdot_.begin(), n, taylor_.begin() + static_cast<std::ptrdiff_t>(n));
    taylor_before_ = taylor_;
    guess = {taylor_.data(), taylor_before_.data(), integrator.weights.inverse()};
  }
  try {
    if (system.move_to(t) != PointStatus::ok) return false;
    system.restore(w_.data(), from_.data(), guess, x_.data());
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return false;
  }
  return all_finite(x_.data(), n);
}

double HeldSlopes::size_of_change(Integrator& integrator, double h, const std::vector<double>& slope) {
  for (std::size_t i = 0; i < slope.size(); ++i) w_[i] = h * slope[i];
  integrator.system.error_in_x(w_.data(), x_.data());
  return integrator.weights.norm(x_.data());
}

}  // namespace sfdae::core
