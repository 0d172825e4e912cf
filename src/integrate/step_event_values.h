// Values of the user's event functions within the last step of an integrator.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <utility>

#include "integrate/integrator.h"
#include "integrate/step_output.h"
#include "watch/event_values.h"
#include "watch/events.h"

namespace sfdae::core {

// A step along which events are searched.
struct SearchedStep {
  Events& events;
  Integrator& integrator;
  StepOutput& output;
  const IntegrationOptions& options;

  // t, or the start of the step if x has jumped between them: values at a jump are those after it.
  double place_of(double t) const {
    const StepState state = integrator.stepper->state();
    const double start = state.t - state.last.h;
    return (t - start) * integrator.direction < 0.0 ? start : t;
  }
};

class StepEventValues final : public EventValues {
 public:
  explicit StepEventValues(const SearchedStep& step) : step_(step), events_(step.events) {}

  bool approximate(double t, double* g) override;
  void determine(double t, bool may_improve, double* g) override;
  // The largest change among several: a single one may cancel by chance.
  void rounding(double* noise) override;
  void keep() override { events_.candidate = events_.now; }
  void accept() override {
    std::swap(events_.searched, events_.candidate);
    events_.has_slopes = !events_.tries_without_slopes;
  }

  // Measures errors of g by the polynomial, at places given as parts of the last step from its end. The step size
  // depends on w = W x; algebraic components may vary faster, and their polynomials are inaccurate then.
  void measure_rough_error(std::span<const double> places);
  // Replaces the polynomials by exact points of the step, as many as rates of change of g require.
  void distrust();
  // True if g at the end of the step, which the polynomials interpolate, agrees with extrapolation from previous steps.
  bool is_expected(double t_end);

 private:
  void evaluate_consistently(double t, std::vector<double>& g);
  bool is_misleading(const std::vector<double>& rough) const;
  void look_at_rates();
  bool determine_without_slopes(double t, bool may_improve, double* g);
  void stop_if_asked(double t) const;

  SearchedStep step_;
  Events& events_;
};

}  // namespace sfdae::core
