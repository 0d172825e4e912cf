// Sensitivities of an integration: how its points are moved to for them.
// SPDX-License-Identifier: BSD-3-Clause
#include <utility>
#include <vector>

#include "integrate/integration.h"
#include "integrate/integration_results.h"
#include "integrate/kinks.h"

namespace sfdae::core {

void Integration::carry(std::unique_ptr<Companion> companion) {
  companion->start(integrator_);
  companion_ = std::move(companion);
}

void Integration::carry_archived(std::unique_ptr<Sensitivities> sensitivities, Archive& archive) {
  sensitivities->archive(archive, integrator_);
  companion_ = std::move(sensitivities);
}

void Integration::archive_sensitivities(Archive& archive) {
  if (auto* carried = dynamic_cast<Sensitivities*>(companion_.get())) carried->archive(archive, integrator_);
}

CallResult Integration::evaluate_sensitivities(double t, double* S, double* Sdot) {
  const StepState state = integrator_.stepper->state();
  const double start = state.t - state.last.h;
  const double place = beside_kink(options_, integrator_, t);
  if ((place - start) * integrator_.direction < 0.0 || (state.t - place) * integrator_.direction < 0.0)
    return result_outside_last_step(t, start, state.t);
  Sensitivities& sensitivities = dynamic_cast<Sensitivities&>(*companion_);
  if (Sdot == nullptr && place == state.t) {
    sensitivities.copy_last(S);
    return {};
  }
  // From the point accepted last, whatever has been asked for since: checkpoints know nothing of that.
  DaeSystem& system = integrator_.system;
  if (system.move_to(state.t) == PointStatus::callback_error) system.callback_error().raise();
  const std::size_t n = index(system.unknowns());
  std::vector<double> x(n), xdot(n);
  const auto move = [&](double at, Slopes slopes) {
    output_.evaluate_aside(integrator_, {at, true, slopes}, options_, x.data(), xdot.data());
    return xdot.data();
  };
  if (sensitivities.needs_stages(integrator_, place)) {
    sensitivities.evaluate_by_stages(
        integrator_, place, [&](double at) { return move(at, Slopes::wanted); }, S, Sdot);
  } else {
    move(place, Slopes::none);
    sensitivities.evaluate(integrator_, place, S, Sdot);
  }
  return {};
}

CallResult Integration::gradient(const WeightedTimes& weighted, double* gradient) {
  DiscreteAdjoint& adjoint = dynamic_cast<DiscreteAdjoint&>(*companion_);
  std::vector<std::size_t> points;
  for (double t : weighted.times) {
    const auto point = adjoint.point_at(beside_kink(options_, integrator_, t));
    if (!point)
      return {
          SFDAE_ILLEGAL_ARGUMENT,
          format("t = %.15g is neither the start nor a time that sfdae_advance has been asked to go to; the nearest "
                 "end of a step is at t = %.15g.",
                 t, adjoint.nearest_time(t))};
    points.push_back(*point);
  }
  // The equations are evaluated where they were, on the same sides of kinks.
  const auto move_to = [this](double t) {
    keep_to_piece(options_, integrator_.system, {t, t, integrator_.direction}, start_);
  };
  try {
    adjoint.gradient({points, weighted.weights, weighted.functionals}, move_to, gradient);
  } catch (...) {
    move_to(integrator_.stepper->state().t);
    throw;
  }
  move_to(integrator_.stepper->state().t);
  return {};
}

}  // namespace sfdae::core
