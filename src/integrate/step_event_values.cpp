// Values of event functions within the last step.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/step_event_values.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "linalg/matrix.h"
#include "linalg/rank.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Relative changes of x, x' and t by assumed rounding errors, and number of trials
// (docs/design/events_and_switching.md).
constexpr double rounding_unit = 8.0 * unit_roundoff;
constexpr int patterns = 8;
// Rough values of g are trusted if they exceed their error by this factor: it is measured at one point only.
constexpr double clearly_wrong = 8.0;
// A polynomial whose error is this part of g is misleading. (Chosen.)
constexpr double misleading_part = 0.1, no_trust = 1e300;
// Places in the last step, as parts from its end, and interval for rates of change of g. (Chosen.)
constexpr double rate_places[] = {0.4, 0.153, 0.771, 0.587, 0.914}, rate_part = 1e-5;
// Smaller errors, relative to g, change no sign that is not examined anyway. (Chosen.)
constexpr double negligible_change_of_g = 1e-4;

// Pseudo-random rounding errors, the same in every run.
class RandomSigns {
 public:
  double changed(double value) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;  // Knuth's MMIX generator
    return value * (1.0 + (state_ >> 63 != 0 ? rounding_unit : -rounding_unit));
  }
  void change(const Vector& values, Vector& changed_values) {
    for (std::size_t i = 0; i < values.size(); ++i) changed_values[i] = changed(values[i]);
  }

 private:
  std::uint64_t state_ = 1;
};

bool are_finite(const Vector& values) { return all_finite(values.data(), values.size()); }

Failure failure_of(int status, double t, const Vector& g) {
  if (status < 0)
    return Failure(SFDAE_CALLBACK_STOPPED, format("the event function returned %d at t = %.15g.", status, t));
  if (status > 0)
    return Failure(
        SFDAE_CALLBACK_FAILED,
        format("the event function returned %d at t = %.15g: it must be defined on the solution.", status, t));
  const auto bad = std::find_if(g.begin(), g.end(), [](double value) { return !std::isfinite(value); });
  return Failure(SFDAE_NOT_FINITE, format("g[%d] of the event function is %g at t = %.15g.",
                                          static_cast<int>(bad - g.begin()), *bad, t));
}

}  // namespace

bool StepEventValues::approximate(double t, double* g) {
  // Without differential equations steps have any length, and polynomials are inaccurate.
  if (step_.integrator.system.differential() == 0) return false;
  Events::Point& rough = events_.rough;
  Vector& values = events_.g_rough;
  step_.output.interpolate(*step_.integrator.stepper, step_.place_of(t), rough.x.data(), rough.xdot.data());
  if (!are_finite(rough.x) || !are_finite(rough.xdot)) return false;
  const int status = events_.evaluate(t, rough, values);
  stop_if_asked(t);
  // g may be undefined at points that slightly violate the constraints.
  if (status != 0 || !are_finite(values)) return false;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::fabs(values[i]) < clearly_wrong * events_.rough_error[i]) return false;
  std::copy(values.begin(), values.end(), g);
  return true;
}

bool StepEventValues::is_expected(double t_end) {
  Vector& g = events_.g_now;
  return approximate(t_end, g.data()) && events_.resolution.expects(t_end, g);
}

void StepEventValues::measure_rough_error(std::span<const double> places) {
  const StepState state = step_.integrator.stepper->state();
  Vector& error = events_.rough_error;
  for (const double place : places) {
    const double t = state.t - place * state.last.h;
    const Vector &rough = events_.g_rough, &g = events_.g_now;
    // As long as no error is known, the approximation only fails if g is not defined there.
    const bool has_rough = approximate(t, events_.g_now.data());
    if (!has_rough && place != places.front()) continue;
    evaluate_consistently(t, events_.g_now);
    if (!has_rough || is_misleading(rough)) {
      distrust();
      return;
    }
    for (std::size_t i = 0; i < error.size(); ++i) {
      const double difference = std::fabs(rough[i] - g[i]);
      const bool matters = difference > negligible_change_of_g * std::max(std::fabs(rough[i]), std::fabs(g[i]));
      if (matters) error[i] = std::max(error[i], difference);
    }
  }
}

// g at a consistent point of the step. Rough slopes are used unless g is not defined for them; it must be defined for
// the slopes of the solution.
void StepEventValues::evaluate_consistently(double t, Vector& g) {
  Events::Point& now = events_.now;
  int status = 0;
  for (const Slopes slopes : {Slopes::rough, Slopes::wanted}) {
    step_.output.evaluate(step_.integrator, {step_.place_of(t), false, slopes}, step_.options, now.x.data(),
                          now.xdot.data());
    status = events_.evaluate(t, now, g);
    stop_if_asked(t);
    if (status == 0 && are_finite(g)) return;
  }
  throw failure_of(status, t, g);
}

void StepEventValues::distrust() {
  look_at_rates();
  std::fill(events_.rough_error.begin(), events_.rough_error.end(), no_trust);
}

// Errors are compared with the larger of g here and at the start of the step: near a zero g itself is too small.
bool StepEventValues::is_misleading(const Vector& rough) const {
  const Vector &g = events_.g_now, &g_before = events_.search.g();
  for (std::size_t i = 0; i < g.size(); ++i)
    if (events_.resolution.looks_at(i) &&
        std::fabs(rough[i] - g[i]) >
            misleading_part * std::max({std::fabs(g[i]), std::fabs(rough[i]), std::fabs(g_before[i])}))
      return true;
  return false;
}

// By finite differences of returned values: x' there may be that of the polynomial.
void StepEventValues::look_at_rates() {
  const LastStep last = step_.integrator.stepper->state().last;
  const double t_end = step_.integrator.stepper->state().t, delta = rate_part * last.h;
  EventResolution& resolution = events_.resolution;
  resolution.start_rates();
  for (const double place : rate_places) {
    const double t = t_end - place * last.h;
    evaluate_consistently(t, events_.g_now);
    evaluate_consistently(t + delta, events_.g_rough);
    resolution.add_rate(delta, events_.g_now, events_.g_rough);
  }
  resolution.take_rates(last.h);
}

// True if g is the same for different x', of either sign, and much larger than those of the step. If g fails for them
// it may require the true x'.
bool StepEventValues::determine_without_slopes(double t, bool may_improve, double* g) {
  constexpr double large = 1e3;
  Events::Point& now = events_.now;
  step_.output.evaluate(step_.integrator, {step_.place_of(t), may_improve, Slopes::none}, step_.options, now.x.data(),
                        now.xdot.data());
  const double h = std::fabs(step_.integrator.stepper->state().last.h), rate = h > 0.0 ? large / h : large;
  const auto evaluate_with = [&](double factor, double turn, Vector& values) {
    for (std::size_t i = 0; i < now.x.size(); ++i)
      now.xdot[i] =
          factor * rate * (1.0 + std::fabs(now.x[i])) * (0.5 + std::fmod(turn * static_cast<double>(i), 1.0));
    const bool is_defined = events_.evaluate(t, now, values) == 0 && are_finite(values);
    stop_if_asked(t);
    return is_defined;
  };
  const bool is_same = evaluate_with(1.0, 0.618, events_.g_rough) && evaluate_with(-0.7, 0.414, events_.g_now) &&
                       events_.g_rough == events_.g_now;
  if (!is_same) return false;
  std::fill(now.xdot.begin(), now.xdot.end(), 0.0);
  events_.t_now = t;
  std::copy(events_.g_now.begin(), events_.g_now.end(), g);
  return true;
}

void StepEventValues::determine(double t, bool may_improve, double* g) {
  if (events_.tries_without_slopes && determine_without_slopes(t, may_improve, g)) return;
  Events::Point& now = events_.now;
  step_.output.evaluate(step_.integrator, {step_.place_of(t), may_improve, Slopes::wanted}, step_.options,
                        now.x.data(), now.xdot.data());
  events_.t_now = t;
  const int status = events_.evaluate(t, now, events_.g_now);
  stop_if_asked(t);
  if (status != 0 || !are_finite(events_.g_now)) throw failure_of(status, t, events_.g_now);
  std::copy(events_.g_now.begin(), events_.g_now.end(), g);
}

void StepEventValues::rounding(double* noise) {
  const Vector& g = events_.g_now;
  const Vector& changed = events_.g_rough;
  std::fill_n(noise, g.size(), 0.0);
  RandomSigns signs;
  for (int k = 0; k < patterns; ++k) {
    signs.change(events_.now.x, events_.rough.x);
    signs.change(events_.now.xdot, events_.rough.xdot);
    const int status = events_.evaluate(signs.changed(events_.t_now), events_.rough, events_.g_rough);
    if (status != 0 || !are_finite(changed)) continue;
    for (std::size_t i = 0; i < g.size(); ++i) noise[i] = std::max(noise[i], std::fabs(changed[i] - g[i]));
  }
}

void StepEventValues::stop_if_asked(double t) const {
  if (step_.integrator.system.stop_is_requested())
    throw Failure(SFDAE_STOPPED,
                  format("stopped on request in the event function at t = %.15g; the call can be repeated.", t));
}

}  // namespace sfdae::core
