// Steps that would not notice what inputs do within them.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/input_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "integrate/radau_method.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "linalg/quiet_arithmetic.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// In tolerances: what a change of slopes amounts to over the step is of no importance; of the change that the ends of a step show, what
// may be hidden between them. (Chosen.)
constexpr double unimportant = 10.0, shown_part = 0.5;
constexpr int most_input_halvings = 30;
// Where slopes cannot be found the step fails of itself, or does not.
constexpr int most_blind_halvings = 3;

}  // namespace

void InputWatch::resize(const DaeSystem& system, int inputs) {
  samples_.resize(inputs);
  const std::size_t n = index(system.unknowns()), size_w = index(system.leading_size());
  for (std::vector<double>* v : {&at_start_, &change_, &here_}) v->assign(size_w, 0.0);
  w_.assign(std::max(n, size_w), 0.0);
  for (std::vector<double>* v : {&x_, &xdot_}) v->assign(n, 0.0);
  const std::size_t columns = system.taylor_order() > 0 ? index(system.taylor_order() + 1) : 2;
  for (std::vector<double>* v : {&taylor_, &taylor_before_}) v->assign(n * columns, 0.0);
}

// Of BDF the last point counts, too.
std::size_t InputWatch::set_nodes(const Integrator& integrator, double h) {
  const StepState state = integrator.stepper->state();
  std::size_t count = 0;
  nodes_[count++] = state.t;
  if (integrator.method == Method::radau) {
    const StageMethod& stages = radau_method((state.next_order + 1) / 2).stages;
    for (int i = 0; i < stages.s; ++i) nodes_[count++] = state.t + stages.c[index(i)] * h;
    return count;
  }
  nodes_[count++] = state.t + h;
  if (state.last.h != 0.0) nodes_[count++] = state.t - state.last.h;
  return count;
}

double InputWatch::noticing_step(Integrator& integrator, TimeInputs& inputs, double h) {
  has_slope_ = false;
  const double t = integrator.stepper->state().t;
  double size = h;
  for (int halvings = 0; halvings < most_input_halvings; ++halvings) {
    const std::span<const double> nodes(nodes_.data(), set_nodes(integrator, size));
    const std::span<const double> places = samples_.unseen(inputs, nodes, t, size, fastest_);
    if (places.empty()) break;
    const std::optional<bool> do_matter = matter(integrator, size, places);
    if (!do_matter.value_or(halvings < most_blind_halvings)) break;
    size *= 0.5;
  }
  if (size != h) fastest_ = fastest_ > 0.0 ? std::fmin(fastest_, std::fabs(size)) : std::fabs(size);
  return size;
}

// Whether the slope of w at one of the places is far from what the ends of the step show; none: slopes cannot be found.
std::optional<bool> InputWatch::matter(Integrator& integrator, double h, std::span<const double> places) {
  const QuietArithmetic quiet;
  const double start = integrator.stepper->state().t;
  integrator.weights.update(integrator.stepper->x().data());
  if (!has_slope_ && !find_slope(integrator, start, at_start_)) return false;
  has_slope_ = true;
  if (!find_slope(integrator, start + h, change_)) return std::nullopt;
  for (std::size_t i = 0; i < change_.size(); ++i) change_[i] -= at_start_[i];
  const double shown = size_of_change(integrator, h, change_);
  for (const double t : places) {
    if (!find_slope(integrator, t, here_)) return std::nullopt;
    const double part = (t - start) / h;
    for (std::size_t i = 0; i < here_.size(); ++i) here_[i] -= at_start_[i] + part * change_[i];
    if (!(size_of_change(integrator, h, here_) <= unimportant + shown_part * shown)) return true;
  }
  return false;
}

// (W x)' at t for w as it is now.
bool InputWatch::find_slope(Integrator& integrator, double t, std::vector<double>& wdot) {
  DaeSystem& system = integrator.system;
  const StepState state = integrator.stepper->state();
  const std::size_t n = x_.size();
  integrator.stepper->interpolate({state.t, w_.data(), x_.data(), xdot_.data()});
  Guess guess;
  if (system.taylor_order() > 0) {
    std::fill(taylor_.begin(), taylor_.end(), 0.0);
    std::copy(x_.begin(), x_.end(), taylor_.begin());
    std::copy_n(xdot_.begin(), n, taylor_.begin() + static_cast<std::ptrdiff_t>(n));
    taylor_before_ = taylor_;
    guess = {taylor_.data(), taylor_before_.data(), integrator.weights.inverse()};
  }
  try {
    if (system.move_to(t) != PointStatus::ok) return false;
    // The point itself is consistent.
    if (t != state.t) system.restore(w_.data(), integrator.stepper->x().data(), guess, x_.data());
    if (!all_finite(x_.data(), n)) return false;
    system.correct_derivative(std::numeric_limits<double>::infinity(), x_.data(), xdot_.data());
    if (!all_finite(xdot_.data(), n)) return false;
    system.leading_derivative(x_.data(), xdot_.data(), wdot.data());
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return false;
  }
  return all_finite(wdot.data(), wdot.size());
}

// Of x, over the step, in tolerances. The slope is lost.
double InputWatch::size_of_change(Integrator& integrator, double h, const std::vector<double>& slope) {
  for (std::size_t i = 0; i < slope.size(); ++i) w_[i] = h * slope[i];
  integrator.system.error_in_x(w_.data(), x_.data());
  return integrator.weights.norm(x_.data());
}

}  // namespace sfdae::core
