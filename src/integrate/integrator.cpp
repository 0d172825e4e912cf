// Integrator of a system.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/integrator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "integrate/bdf.h"
#include "integrate/radau.h"
#include "linalg/index.h"
#include "linalg/rank.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Safety factor of the tolerances of nonlinear problems: errors of nonlinear mechanical systems grow along the
// solution, and users of other codes know this factor (docs/design/derivative_array.md).
constexpr double nonlinear_safety = 0.2;
// Interval of interest after a change of the method, in units of the next step of the previous one: first steps are at
// most about a thousandth of it, and so not much longer than that step.
constexpr double steps_ahead = 1e3;
// Minimum step size in spacings of doubles near t, 2 unit_roundoff each.
constexpr double least_roundings = 4.0;
// If tout is farther away than so many times t, the minimum step is the resolution of that multiple of t, or of this
// part of tout if that is larger. (Chosen: Robertson's kinetics to 1e11 begin with steps of 1e-7; DASSL uses tout
// itself. The resolution of t alone is too small: integrations that cannot continue take 100,000 steps before they
// fail.)
constexpr double farthest_output = 100.0, smallest_part_of_output = 1e-8;

}  // namespace

void Integrator::create(Method wanted, const IntegrationOptions& options) {
  method = wanted == Method::bdf ? Method::bdf : Method::radau;
  if (method == Method::bdf) stepper = std::make_unique<Bdf>();
  else stepper = std::make_unique<Radau>();
  set_options(options);
}

void Integrator::set_options(const IntegrationOptions& options) {
  weights.set(options.tolerances, stepper->tightening(), system.is_linear() ? 1.0 : nonlinear_safety);
  weights.set_floor(system.rounding_errors());
  if (!stepper->x().empty()) weights.update(stepper->x().data());
  StepOptions stepping = options.stepping;
  stepping.interpolates = !options.never_pass_output;
  stepper->set_options(stepping);
}

void Integrator::start(double t, const Vector& x, const Vector& xdot, const IntegrationOptions& options) {
  const double h = direction * (options.initial_step > 0.0 ? options.initial_step : first_step);
  const std::size_t size = index(system.leading_size());
  Vector w(size), wdot(size);
  system.leading(x.data(), w.data());
  system.leading_derivative(x.data(), xdot.data(), wdot.data());
  weights.update(x.data());
  DifferenceCheck first = differences;
  first.accept(system, weights, x.data(), true);
  stepper->start(system, {t, x, xdot, w, wdot}, h);
  system.accept();
  differences = std::move(first);
}

void Integrator::restart(Method wanted, const IntegrationOptions& options) {
  const StepState state = stepper->state();
  if (system.move_to(state.t) == PointStatus::callback_error) system.callback_error().raise();
  const Vector x = stepper->x();
  Vector xdot(x.size());
  system.consistent_derivative(x.data(), direction, xdot.data());
  if (wanted == method) {
    start(state.t, x, xdot, options);
  } else {
    Integrator next(system, direction);
    next.create(wanted, options);
    const double span = steps_ahead * std::fabs(state.next_step);
    next.first_step = next.stepper->first_step(next.weights, x.data(), xdot.data(), span);
    next.start(state.t, x, xdot, options);
    method = next.method;
    stepper = std::move(next.stepper);
    weights = std::move(next.weights);
    first_step = next.first_step;
  }
  must_restart = false;
}

double Integrator::resolution(double t, double tout) {
  return least_roundings * 2.0 * unit_roundoff * std::max(std::fabs(t), std::fabs(tout));
}

double Integrator::smallest_step(double t, double tout) {
  const double end = std::fabs(tout),
               nearby = std::max(farthest_output * std::fabs(t), smallest_part_of_output * end);
  return resolution(t, std::min(end, nearby));
}

}  // namespace sfdae::core
