// The Jacobian of what is iterated for a mechanical system, by differences of its functions.
//
// It serves to find a solution, not to define it: differences of lowest order are enough. As s is the derivative of
// C v + r along (1, S v) with v held, its derivative by v is dC/dt + (C v + r)_q S and takes none.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/rank.h"
#include "multibody/multibody_callbacks.h"

namespace sfdae::core {

namespace {

// Increments relative to the size of a component: of values, of what is a difference itself.
const double increment = std::sqrt(unit_roundoff);
constexpr double wide_increment = 1e-5;
// Of low-order differences along the motion: of values, of what is divided by an increment again. The latter is
// relative to the spacing of nine points that has proved good.
constexpr double spacing = 1e-5, rough_spacing = 1.0 / 64.0;

// Column j of a Jacobian.
void write_quotient(const std::vector<double>& moved, const std::vector<double>& base, double offset, View column) {
  for (int i = 0; i < column.rows; ++i) column(i, 0) = (moved[index(i)] - base[index(i)]) / offset;
}

}  // namespace

bool CallbackMultibody::residuals(const Point& at, const double* a, const double* mu, Residuals& result,
                                  CallbackError& error) {
  const int nv = sizes().velocities;
  if (!evaluate_mass(at, probe_.M, error) || !evaluate_constraints(at, probe_, error) ||
      !call("forces", functions_.forces, at, {result.force.data(), nv, 1, nv}, error) ||
      !evaluate_curvatures(at, result.acceleration.data(), error))
    return false;
  multiply(-1.0, Op::plain, probe_.M, a, 1.0, result.force.data());
  velocity_of(probe_.S, at.v, result.kinematics.data());
  if (sizes().constraints() == 0) return true;
  multiply(-1.0, Op::transposed, probe_.C, mu, 1.0, result.force.data());
  multiply(1.0, Op::plain, probe_.C, a, 1.0, result.acceleration.data());
  std::copy(probe_.velocity_rest.begin(), probe_.velocity_rest.end(), result.velocity.begin());
  multiply(1.0, Op::plain, probe_.C, at.v, 1.0, result.velocity.data());
  return true;
}

CallbackMultibody::Increments CallbackMultibody::increments(double t, double along, double in_time) const {
  Increments steps{along < std::numeric_limits<double>::infinity() ? along : 0.0, 0.0, 0.0};
  if (may_depend_on_time()) {
    steps.before = std::min(in_time, std::max(room(t, -1.0), 0.0));
    steps.after = std::min(in_time, std::max(room(t, 1.0), 0.0));
  }
  return steps;
}

bool CallbackMultibody::rough_rest(const Point& at, const Increments& steps, double* s, CallbackError& error) {
  const int rows = sizes().constraints();
  std::fill_n(s, rows, 0.0);
  const auto add = [&](const Line& line, double before, double after) {
    if (before + after == 0.0) return true;
    if (!at_offset(at, line, after, along_.data(), error) || !at_offset(at, line, -before, in_time_.data(), error))
      return false;
    for (int i = 0; i < rows; ++i) s[i] += (along_[index(i)] - in_time_[index(i)]) / (before + after);
    return true;
  };
  return add({0.0, 1.0, 0.0, 0.0, 0.0}, steps.along, steps.along) &&
         add({1.0, 0.0, 0.0, 0.0, 0.0}, steps.before, steps.after);
}

bool CallbackMultibody::add_rate_of_C(const Point& at, const Increments& steps, View rate, CallbackError& error) {
  const auto add = [&](const Line& line, double before, double after) {
    if (before + after == 0.0) return true;
    for (const double offset : {after, -before}) {
      std::copy_n(at.q, sizes().positions, shifted_q_.data());
      for (std::size_t i = 0; i < shifted_q_.size(); ++i) shifted_q_[i] += offset * line.q_rate * direction_[i];
      if (!evaluate_constraints({at.t + offset * line.t_rate, shifted_q_.data(), at.v}, probe_, error)) return false;
      const double factor = (offset == after ? 1.0 : -1.0) / (before + after);
      for (int j = 0; j < rate.cols; ++j)
        for (int i = 0; i < rate.rows; ++i) rate(i, j) += factor * probe_.C(i, j);
    }
    return true;
  };
  return add({0.0, 1.0, 0.0, 0.0, 0.0}, steps.along, steps.along) &&
         add({1.0, 0.0, 0.0, 0.0, 0.0}, steps.before, steps.after);
}

template <class Evaluate>
double CallbackMultibody::move(const double* values, int j, std::vector<double>& moved, CallbackError& error,
                               Evaluate evaluate) {
  const int count = static_cast<int>(moved.size());
  const double unit = unit_of(values, count, j);
  for (const double wanted : {increment * unit, -increment * unit}) {
    std::copy_n(values, count, moved.data());
    moved[index(j)] += wanted;
    error = {};
    if (evaluate()) return moved[index(j)] - values[j];
    if (!error.is_recoverable()) return 0.0;
  }
  return 0.0;
}

bool CallbackMultibody::position_column(const LinearizationPoint& point, int j, MultibodyJacobian& jacobian,
                                        CallbackError& error) {
  const Point moved{point.at.t, moved_q_.data(), point.at.v};
  const auto evaluate = [&] { return residuals(moved, point.a, point.mu, moved_, error); };
  const double offset = move(point.at.q, j, moved_q_, error, evaluate);
  if (offset == 0.0) return false;
  const auto column = [j](Matrix& matrix) { return matrix.view().columns(j, 1); };
  write_quotient(moved_.force, base_.force, offset, column(jacobian.force_q));
  if (has_kinematics()) write_quotient(moved_.kinematics, base_.kinematics, offset, column(jacobian.kinematics_q));
  if (sizes().constraints() == 0) return true;
  write_quotient(moved_.acceleration, base_.acceleration, offset, column(jacobian.acceleration_q));
  write_quotient(moved_.velocity, base_.velocity, offset, column(jacobian.velocity_q));
  return !needs_differences() || add_rough_column(point, j, offset, column(jacobian.acceleration_q), error);
}

// offset: that of moved_.
bool CallbackMultibody::add_rough_column(const LinearizationPoint& point, int j, double offset, View column,
                                         CallbackError& error) {
  const double* const q = point.at.q;
  const double wide = std::copysign(wide_increment * unit_of(q, sizes().positions, j), offset);
  moved_q_[index(j)] = q[j] + wide;
  for (std::size_t i = 0; i < direction_.size(); ++i)
    direction_[i] = base_.kinematics[i] + (moved_.kinematics[i] - base_.kinematics[i]) * (wide / offset);
  if (!rough_rest({point.at.t, moved_q_.data(), point.at.v}, point.steps, rough_moved_.data(), error)) return false;
  for (int i = 0; i < column.rows; ++i) column(i, 0) += (rough_moved_[index(i)] - rough_base_[index(i)]) / wide;
  return true;
}

bool CallbackMultibody::velocity_column(const Point& at, int j, const std::vector<double>& forces, View force_v,
                                        CallbackError& error) {
  const int nv = sizes().velocities;
  const Point moved{at.t, at.q, moved_v_.data()};
  const auto evaluate = [&] {
    return call("forces", functions_.forces, moved, {moved_.force.data(), nv, 1, nv}, error);
  };
  const double offset = move(at.v, j, moved_v_, error, evaluate);
  if (offset == 0.0) return false;
  write_quotient(moved_.force, forces, offset, force_v.columns(j, 1));
  return true;
}

CallbackError CallbackMultibody::linearize(const MultibodyState& state, const MultibodyTerms& terms,
                                           MultibodyJacobian& jacobian) {
  CallbackError error;
  ++linearizations_;
  const auto [t, q, v, a, mu] = state;
  const int nq = sizes().positions, nv = sizes().velocities, rows = sizes().constraints();
  if (has_kinematics() && jacobian.kinematics_q.cols() == 0) jacobian.kinematics_q = Matrix(nq, nq);
  if (!residuals({t, q, v}, a, mu, base_, error)) return error;
  direction_ = base_.kinematics;
  if (needs_differences() && !add_differences({t, q, v}, terms, rough_base_.data(), error)) return error;
  const LinearizationPoint point{
      {t, q, v}, a, mu, increments(t, rough_spacing * good_step_, rough_spacing * good_time_)};
  const View acceleration_v = jacobian.acceleration_v;
  fill(acceleration_v, 0.0);
  const Increments steps = increments(t, spacing * step_along_motion(q), spacing * unit_of_time(t));
  if (rows > 0 && !add_rate_of_C(point.at, steps, acceleration_v, error)) return error;
  if (needs_differences() && !rough_rest(point.at, point.steps, rough_base_.data(), error)) return error;
  for (int j = 0; j < nq; ++j)
    if (!position_column(point, j, jacobian, error)) return error;
  for (int j = 0; j < nv; ++j)
    if (!velocity_column(point.at, j, terms.f, jacobian.force_v, error)) return error;
  if (rows == 0) return error;
  if (has_kinematics()) {
    multiply(1.0, Op::plain, jacobian.velocity_q, Op::plain, terms.S, 1.0, acceleration_v);
  } else {
    for (int j = 0; j < nv; ++j)
      for (int i = 0; i < rows; ++i) acceleration_v(i, j) += jacobian.velocity_q(i, j);
  }
  return error;
}

}  // namespace sfdae::core
