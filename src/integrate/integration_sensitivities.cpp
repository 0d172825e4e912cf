// Sensitivities of an integration: how its points are moved to for them.
// SPDX-License-Identifier: BSD-3-Clause
#include <utility>
#include <vector>

#include "integrate/integration.h"
#include "integrate/integration_results.h"
#include "integrate/kinks.h"

namespace sfdae::core {

void Integration::carry(std::unique_ptr<Sensitivities> sensitivities) {
  sensitivities->start(integrator_);
  sensitivities_ = std::move(sensitivities);
}

CallResult Integration::evaluate_sensitivities(double t, double* S, double* Sdot) {
  const StepState state = integrator_.stepper->state();
  const double start = state.t - state.last.h;
  const double place = beside_kink(options_, integrator_, t);
  if ((place - start) * integrator_.direction < 0.0 || (state.t - place) * integrator_.direction < 0.0)
    return result_outside_last_step(t, start, state.t);
  if (Sdot == nullptr && place == state.t) {
    sensitivities_->copy_last(S);
    return {};
  }
  const std::size_t n = index(integrator_.system.unknowns());
  std::vector<double> x(n), xdot(n);
  const auto move = [&](double at, Slopes slopes) {
    output_.evaluate_aside(integrator_, {at, true, slopes}, options_, x.data(), xdot.data());
    return xdot.data();
  };
  if (sensitivities_->needs_stages(integrator_, place)) {
    sensitivities_->evaluate_by_stages(
        integrator_, place, [&](double at) { return move(at, Slopes::wanted); }, S, Sdot);
  } else {
    move(place, Slopes::none);
    sensitivities_->evaluate(integrator_, place, S, Sdot);
  }
  return {};
}

}  // namespace sfdae::core
