// The user's functions of a mechanical system: called and checked.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_functions.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

View column(double* values, int count) { return {values, count, 1, std::max(count, 1)}; }

void describe_code(const char* name, CallbackError& error) {
  error.status = error.code < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED;
  error.detail = format("%s returned %d (%s) at %s.", name, error.code, error.code < 0 ? "stop" : "cannot evaluate",
                        error.where().c_str());
}

void describe_entry(const char* name, ConstView result, CallbackError& error) {
  error.status = SFDAE_NOT_FINITE;
  int first = 0;
  while (all_finite(result.data + first, 1)) ++first;
  error.row = first % result.rows;
  error.column = first / result.rows;
  error.detail = format(
      "%s returned NaN, Inf or a number near overflow in row %d, column %d at %s. Return 1 "
      "from the callback to have the step reduced.",
      name, error.row, error.column, error.where().c_str());
}

}  // namespace

MultibodySizes sizes_of(const sfdae_multibody_problem& problem) {
  const int velocities = problem.num_velocities == 0 ? problem.num_positions : problem.num_velocities;
  return {problem.num_positions, velocities, problem.num_constraints, problem.num_nonholonomic};
}

MultibodyFunctions::MultibodyFunctions(const sfdae_multibody_problem& given, const MultibodyProblem& problem)
    : given_(given), problem_(problem), H_(problem.sizes().nonholonomic, problem.sizes().velocities) {}

template <class Call>
bool MultibodyFunctions::checked(const char* name, double t, View result, CallbackError& error, Call call) const {
  const std::size_t count = index(result.rows) * index(result.cols);
  if (count == 0) return true;
  std::fill_n(result.data, count, 0.0);
  error.function = name;
  error.t = t;
  error.user_t = problem_.user_t();
  if (problem_.stop_is_requested()) {
    error.status = SFDAE_STOPPED;
    return false;
  }
  error.code = call(result.data);
  if (error.code != 0) describe_code(name, error);
  else if (!all_finite(result.data, count)) describe_entry(name, result, error);
  return error.status == SFDAE_OK;
}

bool MultibodyFunctions::call(const char* name, sfdae_position_function function, const MultibodyArguments& at,
                              View result, CallbackError& error) const {
  return checked(name, at.t, result, error,
                 [&](double* values) { return function == nullptr ? 0 : function(at.t, at.q, values, given_.user); });
}

bool MultibodyFunctions::call(const char* name, sfdae_velocity_function function, const MultibodyArguments& at,
                              View result, CallbackError& error) const {
  return checked(name, at.t, result, error, [&](double* values) {
    return function == nullptr ? 0 : function(at.t, at.q, at.v, values, given_.user);
  });
}

bool MultibodyFunctions::mass(const MultibodyArguments& at, Matrix& M, CallbackError& error) const {
  if (given_.mass != nullptr) return call("mass", given_.mass, at, M, error);
  fill(M, 0.0);
  for (int i = 0; i < M.rows(); ++i) M(i, i) = 1.0;
  return true;
}

bool MultibodyFunctions::forces(const MultibodyArguments& at, double* f, CallbackError& error) const {
  return call("forces", given_.forces, at, column(f, sizes().velocities), error);
}

bool MultibodyFunctions::constraints(const MultibodyArguments& at, double* g, CallbackError& error) const {
  return call("constraints", given_.constraints, at, column(g, sizes().holonomic), error);
}

bool MultibodyFunctions::kinematics(const MultibodyArguments& at, Matrix& S, CallbackError& error) const {
  if (!has_kinematics()) return true;
  if (S.cols() == 0) S = Matrix(sizes().positions, sizes().velocities);
  return call("kinematics", given_.kinematics, at, S, error);
}

bool MultibodyFunctions::constraint_derivatives(const MultibodyArguments& at, Matrix& g_q, double* g_t,
                                                CallbackError& error) const {
  return call("constraint_jacobian", given_.constraint_jacobian, at, g_q, error) &&
         call("constraint_rate", given_.constraint_rate, at, column(g_t, sizes().holonomic), error);
}

bool MultibodyFunctions::nonholonomic(const MultibodyArguments& at, Matrix& H, double* h,
                                      CallbackError& error) const {
  return call("nonholonomic_matrix", given_.nonholonomic_matrix, at, H, error) &&
         call("nonholonomic_offset", given_.nonholonomic_offset, at, column(h, sizes().nonholonomic), error);
}

bool MultibodyFunctions::velocity_constraints(const MultibodyArguments& at, MultibodyTerms& terms,
                                              CallbackError& error) {
  const int nv = sizes().velocities, nl = sizes().holonomic, nk = sizes().nonholonomic;
  double* const rest = terms.velocity_rest.data();
  if (!kinematics(at, terms.S, error) || !constraint_derivatives(at, terms.g_q, rest, error) ||
      !nonholonomic(at, H_, rest + nl, error))
    return false;
  const View C = terms.C;
  if (nl > 0 && has_kinematics()) multiply(1.0, Op::plain, terms.g_q, Op::plain, terms.S, 0.0, C.block(0, 0, nl, nv));
  else if (nl > 0) copy(terms.g_q, C.block(0, 0, nl, nv));
  if (nk > 0) copy(H_, C.block(nl, 0, nk, nv));
  return true;
}

bool MultibodyFunctions::curvatures(const MultibodyArguments& at, double* s, CallbackError& error) const {
  const int nl = sizes().holonomic, nk = sizes().nonholonomic;
  return call("constraint_curvature", given_.constraint_curvature, at, column(s, nl), error) &&
         call("nonholonomic_curvature", given_.nonholonomic_curvature, at, column(s + nl, nk), error);
}

void MultibodyFunctions::velocity(const Matrix& S, const double* v, double* result) const {
  if (has_kinematics()) multiply(1.0, Op::plain, S, v, 0.0, result);
  else std::copy_n(v, sizes().positions, result);
}

}  // namespace sfdae::core
