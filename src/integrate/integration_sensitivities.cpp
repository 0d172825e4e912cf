// Sensitivities of an integration: moving the system to points for them.
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

double Integration::start_of_last_step() const {
  const StepState state = integrator_.stepper->state();
  return state.t - state.last.h;
}

bool Integration::is_outside_last_step(double t) const {
  return (t - start_of_last_step()) * integrator_.direction < 0.0 ||
         (integrator_.stepper->state().t - t) * integrator_.direction < 0.0;
}

// Moves the system to the last point: results must not depend on earlier requests, which checkpoints do not contain.
void Integration::return_to_last_point() {
  DaeSystem& system = integrator_.system;
  if (system.move_to(integrator_.stepper->state().t) == PointStatus::callback_error) system.callback_error().raise();
}

CallResult Integration::evaluate_sensitivities(double t, double* S, double* Sdot) {
  const double last = integrator_.stepper->state().t, place = beside_kink(options_, integrator_, t);
  if (is_outside_last_step(place)) return result_outside_last_step(t, start_of_last_step(), last);
  Sensitivities& sensitivities = dynamic_cast<Sensitivities&>(*companion_);
  if (Sdot == nullptr && place == last) {
    sensitivities.copy_last(S);
    return {};
  }
  return_to_last_point();
  const std::size_t n = index(integrator_.system.unknowns());
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
  std::vector<DiscreteAdjoint::Place> places;
  for (double t : weighted.times) {
    const auto place = adjoint.place_of(beside_kink(options_, integrator_, t));
    if (!place)
      return {SFDAE_ILLEGAL_ARGUMENT,
              format("t = %.15g is not where steps have led: these go from t = %.15g to t = %.15g.", t, start_,
                     integrator_.stepper->state().t)};
    places.push_back(*place);
  }
  // The equations are evaluated as in the integration, on the same sides of kinks.
  const auto keep_beside = [this](DaeSystem& system, double t) {
    keep_to_piece(options_, system, {t, t, integrator_.direction}, start_);
  };
  try {
    adjoint.gradient({places, weighted.weights, weighted.functionals}, {keep_beside, options_.tolerances}, gradient);
  } catch (...) {
    keep_to_last_piece();
    throw;
  }
  keep_to_last_piece();
  return {};
}

void Integration::keep_to_last_piece() {
  const double t = integrator_.stepper->state().t;
  keep_to_piece(options_, integrator_.system, {t, t, integrator_.direction}, start_);
}

void Integration::keep_steps_alone() {
  watch_.reset();
  branches_ = {};
  options_.events = nullptr;
  recording_.solution = {};
}

CallResult Integration::end_at(double t, TangentSpace& space) {
  const double place = beside_kink(options_, integrator_, t);
  if (is_outside_last_step(place))
    return result_outside_last_step(t, start_of_last_step(), integrator_.stepper->state().t);
  DiscreteAdjoint& adjoint = dynamic_cast<DiscreteAdjoint&>(*companion_);
  return_to_last_point();
  const std::size_t n = index(integrator_.system.unknowns());
  std::vector<double> x(n), xdot(n);
  const auto move_to = [&](double at) -> const double* {
    output_.evaluate_aside(integrator_, {at, true, Slopes::wanted}, options_, x.data(), xdot.data());
    return xdot.data();
  };
  if (place != integrator_.stepper->state().t) {
    adjoint.end_within(integrator_, place, move_to);
    output_.evaluate_aside(integrator_, {place, true, Slopes::none}, options_, x.data(), nullptr);
  }
  space = adjoint.tangent_space();
  adjoint.drop_all();
  return {};
}

}  // namespace sfdae::core
