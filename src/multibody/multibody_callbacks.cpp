// The user's functions of a mechanical system.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_callbacks.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

View as_view(std::vector<double>& values) {
  const int count = static_cast<int>(values.size());
  return {values.data(), count, 1, std::max(count, 1)};
}

void describe_code(const char* name, CallbackError& error) {
  error.status = error.code < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED;
  error.detail = format("%s returned %d (%s) at t = %.15g.", name, error.code,
                        error.code < 0 ? "stop" : "cannot evaluate", error.t);
}

void describe_entry(const char* name, ConstView result, CallbackError& error) {
  error.status = SFDAE_NOT_FINITE;
  int first = 0;
  while (all_finite(result.data + first, 1)) ++first;
  error.row = first % result.rows;
  error.column = first / result.rows;
  error.detail = format(
      "%s returned NaN, Inf or a number near overflow in row %d, column %d at t = %.15g. Return 1 "
      "from the callback to have the step reduced.",
      name, error.row, error.column, error.t);
}

}  // namespace

MultibodySizes sizes_of(const sfdae_multibody_problem& problem) {
  const int velocities = problem.num_velocities == 0 ? problem.num_positions : problem.num_velocities;
  return {problem.num_positions, velocities, problem.num_constraints, problem.num_nonholonomic};
}

CallbackMultibody::Residuals::Residuals(const MultibodySizes& sizes)
    : force(index(sizes.velocities)),
      acceleration(index(sizes.constraints())),
      velocity(index(sizes.constraints())),
      kinematics(index(sizes.positions)) {}

CallbackMultibody::CallbackMultibody(const sfdae_multibody_problem& problem)
    : MultibodyProblem(sizes_of(problem)),
      functions_(problem),
      gamma_by_differences_(sizes().holonomic > 0 && problem.constraint_curvature == nullptr),
      eta_by_differences_(sizes().nonholonomic > 0 && problem.nonholonomic_curvature == nullptr),
      H_(sizes().nonholonomic, sizes().velocities),
      probe_(sizes()),
      direction_(index(sizes().positions)),
      shifted_q_(direction_),
      shifted_direction_(direction_),
      base_(sizes()),
      moved_(sizes()),
      moved_q_(direction_),
      moved_v_(index(sizes().velocities)) {
  constexpr int points = DifferenceFormula::points;
  const std::size_t rows = index(sizes().constraints());
  for (int shift = 0; shift < points; ++shift) formulas_.emplace_back(shift, 1);
  samples_.resize(rows * points);
  for (auto* values : {&values_, &errors_, &along_, &in_time_, &rough_base_, &rough_moved_}) values->resize(rows);
}

template <class Call>
bool CallbackMultibody::checked(const char* name, double t, View result, CallbackError& error, Call call) {
  const std::size_t count = index(result.rows) * index(result.cols);
  if (count == 0) return true;
  std::fill_n(result.data, count, 0.0);
  error.function = name;
  error.t = t;
  if (stop_is_requested()) {
    error.status = SFDAE_STOPPED;
    return false;
  }
  error.code = call(result.data);
  if (error.code != 0) describe_code(name, error);
  else if (!all_finite(result.data, count)) describe_entry(name, result, error);
  return error.status == SFDAE_OK;
}

// A function that is not given is zero.
bool CallbackMultibody::call(const char* name, sfdae_position_function function, const Point& at, View result,
                             CallbackError& error) {
  return checked(name, at.t, result, error, [&](double* values) {
    return function == nullptr ? 0 : function(at.t, at.q, values, functions_.user);
  });
}

bool CallbackMultibody::call(const char* name, sfdae_velocity_function function, const Point& at, View result,
                             CallbackError& error) {
  return checked(name, at.t, result, error, [&](double* values) {
    return function == nullptr ? 0 : function(at.t, at.q, at.v, values, functions_.user);
  });
}

bool CallbackMultibody::evaluate_mass(const Point& at, Matrix& M, CallbackError& error) {
  if (functions_.mass != nullptr) return call("mass", functions_.mass, at, M, error);
  fill(M, 0.0);
  for (int i = 0; i < M.rows(); ++i) M(i, i) = 1.0;
  return true;
}

bool CallbackMultibody::evaluate_constraints(const Point& at, MultibodyTerms& terms, CallbackError& error) {
  const int nv = sizes().velocities, nl = sizes().holonomic, nk = sizes().nonholonomic;
  if (has_kinematics()) {
    if (terms.S.cols() == 0) terms.S = Matrix(sizes().positions, nv);
    if (!call("kinematics", functions_.kinematics, at, terms.S, error)) return false;
  }
  double* const rest = terms.velocity_rest.data();
  const View g_t{rest, nl, 1, std::max(nl, 1)}, h{rest + nl, nk, 1, std::max(nk, 1)};
  if (!call("constraint_jacobian", functions_.constraint_jacobian, at, terms.g_q, error) ||
      !call("constraint_rate", functions_.constraint_rate, at, g_t, error) ||
      !call("nonholonomic_matrix", functions_.nonholonomic_matrix, at, H_, error) ||
      !call("nonholonomic_offset", functions_.nonholonomic_offset, at, h, error))
    return false;
  const View C = terms.C;
  if (nl > 0 && has_kinematics()) multiply(1.0, Op::plain, terms.g_q, Op::plain, terms.S, 0.0, C.block(0, 0, nl, nv));
  else if (nl > 0) copy(terms.g_q, C.block(0, 0, nl, nv));
  if (nk > 0) copy(H_, C.block(nl, 0, nk, nv));
  return true;
}

bool CallbackMultibody::evaluate_curvatures(const Point& at, double* s, CallbackError& error) {
  const int nl = sizes().holonomic, nk = sizes().nonholonomic;
  return call("constraint_curvature", functions_.constraint_curvature, at, {s, nl, 1, std::max(nl, 1)}, error) &&
         call("nonholonomic_curvature", functions_.nonholonomic_curvature, at, {s + nl, nk, 1, std::max(nk, 1)},
              error);
}

CallbackError CallbackMultibody::constraints(double t, const double* q, double* g) {
  CallbackError error;
  ++evaluations_;
  const int nl = sizes().holonomic;
  call("constraints", functions_.constraints, {t, q, nullptr}, {g, nl, 1, std::max(nl, 1)}, error);
  return error;
}

CallbackError CallbackMultibody::at_position(double t, const double* q, MultibodyTerms& terms) {
  CallbackError error;
  ++evaluations_;
  const Point at{t, q, nullptr};
  (void)(call("constraints", functions_.constraints, at, as_view(terms.g), error) &&
         evaluate_mass(at, terms.M, error) && evaluate_constraints(at, terms, error));
  return error;
}

CallbackError CallbackMultibody::at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) {
  CallbackError error = at_position(t, q, terms);
  if (error.status != SFDAE_OK) return error;
  const Point at{t, q, v};
  double* const s = terms.acceleration_rest.data();
  (void)(call("forces", functions_.forces, at, as_view(terms.f), error) && evaluate_curvatures(at, s, error) &&
         (!needs_differences() || add_differences(at, terms, s, error)));
  return error;
}

void CallbackMultibody::check_rates(double t, const double* q) {
  if (sizes().holonomic == 0 || functions_.constraint_rate != nullptr) return;
  std::vector<double> here(index(sizes().holonomic)), later(here);
  const double forward = room(t, 1.0), backward = room(t, -1.0), step = 1e-3 * std::max(1.0, std::fabs(t));
  const double offset = forward >= backward ? std::min(step, forward) : -std::min(step, backward);
  const auto evaluate = [&](double at, double* g) {
    const CallbackError error = constraints(at, q, g);
    if (error.status != SFDAE_OK && !error.is_recoverable()) throw Failure(error.status, error.message());
    return error.status == SFDAE_OK;
  };
  // Two offsets, for the sake of periodic functions.
  for (const double part : {1.0, 0.31}) {
    // The same numbers give the same values: whatever changes depends on t.
    if (!evaluate(t, here.data()) || !evaluate(t + part * offset, later.data())) continue;
    for (std::size_t i = 0; i < here.size(); ++i)
      if (here[i] != later[i])
        throw Failure(
            SFDAE_ILLEGAL_ARGUMENT,
            format("constraint %d depends on t (%.15g at t = %.15g, %.15g at t = %.15g with the same q), but "
                   "there is no constraint_rate: provide the derivative of g by t.",
                   static_cast<int>(i), here[i], t, later[i], t + part * offset));
  }
}

}  // namespace sfdae::core
