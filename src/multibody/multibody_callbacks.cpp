// A mechanical system given by the user's functions.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_callbacks.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

CallbackMultibody::CallbackMultibody(const sfdae_multibody_problem& problem)
    : MultibodyProblem(sizes_of(problem)),
      functions_(problem, *this),
      curvature_(functions_),
      jacobian_(functions_, curvature_) {}

CallbackError CallbackMultibody::constraints(double t, const double* q, double* g) {
  CallbackError error;
  ++evaluations_;
  functions_.constraints({t, q, nullptr}, g, error);
  return error;
}

CallbackError CallbackMultibody::at_position(double t, const double* q, MultibodyTerms& terms) {
  CallbackError error;
  ++evaluations_;
  const MultibodyArguments at{t, q, nullptr};
  (void)(functions_.constraints(at, terms.g.data(), error) && functions_.mass(at, terms.M, error) &&
         functions_.velocity_constraints(at, terms, error));
  return error;
}

CallbackError CallbackMultibody::at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) {
  CallbackError error = at_position(t, q, terms);
  if (error.status != SFDAE_OK) return error;
  const MultibodyArguments at{t, q, v};
  double* const s = terms.acceleration_rest.data();
  (void)(functions_.forces(at, terms.f.data(), error) && functions_.curvatures(at, s, error) &&
         (!curvature_.is_needed() || curvature_.add(at, terms.S, s, error)));
  return error;
}

CallbackError CallbackMultibody::constraint_terms(double t, const double* q, const double* v, MultibodyTerms& terms) {
  CallbackError error;
  ++(is_checking_ ? check_evaluations_ : evaluations_);
  const MultibodyArguments at{t, q, v};
  (void)(functions_.constraints(at, terms.g.data(), error) && functions_.velocity_constraints(at, terms, error) &&
         functions_.curvatures(at, terms.acceleration_rest.data(), error));
  return error;
}

CallbackError CallbackMultibody::linearize(const MultibodyState& state, const MultibodyTerms& terms,
                                           MultibodyJacobian& jacobian) {
  CallbackError error;
  ++linearizations_;
  jacobian_.evaluate(state, terms, jacobian, error);
  return error;
}

void CallbackMultibody::check_rates(double t, const double* q) {
  if (sizes().holonomic == 0 || functions().constraint_rate != nullptr) return;
  std::vector<double> here(index(sizes().holonomic)), later(here);
  const double forward = room(t, 1.0), backward = room(t, -1.0), step = 1e-3 * std::max(1.0, std::fabs(t));
  const double offset = forward >= backward ? std::min(step, forward) : -std::min(step, backward);
  const auto evaluate = [&](double at, double* g) {
    const CallbackError error = constraints(at, q, g);
    if (error.status != SFDAE_OK && !error.is_recoverable()) error.raise();
    return error.status == SFDAE_OK;
  };
  // Two offsets, for the sake of periodic functions: their quotient is no simple fraction.
  for (const double part : {1.0, 0.31}) {
    // The same numbers give the same values, so any change depends on t.
    if (!evaluate(t, here.data()) || !evaluate(t + part * offset, later.data())) continue;
    for (std::size_t i = 0; i < here.size(); ++i)
      if (here[i] != later[i])
        throw Failure(
            SFDAE_ILLEGAL_ARGUMENT,
            format("%s depends on t (%.15g at t = %.15g, %.15g at t = %.15g with the same q), but "
                   "there is no constraint_rate: provide the derivative of g by t.",
                   name_of_constraint(static_cast<int>(i)).c_str(), here[i], t, later[i], t + part * offset));
  }
}

}  // namespace sfdae::core
