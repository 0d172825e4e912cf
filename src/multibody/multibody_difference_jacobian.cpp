// Finite-difference Jacobian of the iterated residuals of a mechanical system.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_difference_jacobian.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

// Increments relative to the size of a component: of values, with about equal errors of rounding and of the formula; of
// differences, which have larger errors.
const double increment = std::sqrt(unit_roundoff);
constexpr double wide_increment = 1e-5;
// Spacings of low-order differences along the motion: of values; of differences to be divided by an increment again.
// The latter is relative to the accurate spacing of nine points.
constexpr double spacing = 1e-5, rough_spacing = 1.0 / 64.0;

// Column j of a Jacobian.
void write_quotient(const std::vector<double>& moved, const std::vector<double>& base, double offset, View column) {
  for (int i = 0; i < column.rows; ++i) column(i, 0) = (moved[index(i)] - base[index(i)]) / offset;
}

}  // namespace

MultibodyDifferenceJacobian::Residuals::Residuals(const MultibodySizes& sizes)
    : force(index(sizes.velocities)),
      acceleration(index(sizes.constraints())),
      velocity(index(sizes.constraints())),
      kinematics(index(sizes.positions)) {}

MultibodyDifferenceJacobian::MultibodyDifferenceJacobian(MultibodyFunctions& functions,
                                                         CurvatureDifferences& curvature)
    : functions_(functions),
      curvature_(curvature),
      probe_(functions.sizes()),
      direction_(index(functions.sizes().positions)),
      shifted_q_(direction_),
      base_(functions.sizes()),
      moved_(functions.sizes()),
      moved_q_(direction_),
      moved_v_(index(functions.sizes().velocities)),
      rough_base_(index(functions.sizes().constraints())),
      rough_moved_(rough_base_) {}

bool MultibodyDifferenceJacobian::residuals(const MultibodyArguments& at, const double* a, const double* mu,
                                            Residuals& result, CallbackError& error) {
  if (!functions_.mass(at, probe_.M, error) || !functions_.velocity_constraints(at, probe_, error) ||
      !functions_.forces(at, result.force.data(), error) ||
      !functions_.curvatures(at, result.acceleration.data(), error))
    return false;
  multiply(-1.0, Op::plain, probe_.M, a, 1.0, result.force.data());
  functions_.velocity(probe_.S, at.v, result.kinematics.data());
  if (functions_.sizes().constraints() == 0) return true;
  multiply(-1.0, Op::transposed, probe_.C, mu, 1.0, result.force.data());
  multiply(1.0, Op::plain, probe_.C, a, 1.0, result.acceleration.data());
  std::copy(probe_.velocity_rest.begin(), probe_.velocity_rest.end(), result.velocity.begin());
  multiply(1.0, Op::plain, probe_.C, at.v, 1.0, result.velocity.data());
  return true;
}

// rate += dC/dt along (1, direction_).
bool MultibodyDifferenceJacobian::add_rate_of_C(const MultibodyArguments& at, const MultibodyIncrements& steps,
                                                View rate, CallbackError& error) {
  const auto add = [&](double t_rate, double q_rate, double before, double after) {
    if (before + after == 0.0) return true;
    for (const double offset : {after, -before}) {
      std::copy_n(at.q, shifted_q_.size(), shifted_q_.data());
      for (std::size_t i = 0; i < shifted_q_.size(); ++i) shifted_q_[i] += offset * q_rate * direction_[i];
      if (!functions_.velocity_constraints({at.t + offset * t_rate, shifted_q_.data(), at.v}, probe_, error))
        return false;
      const double factor = (offset == after ? 1.0 : -1.0) / (before + after);
      for (int j = 0; j < rate.cols; ++j)
        for (int i = 0; i < rate.rows; ++i) rate(i, j) += factor * probe_.C(i, j);
    }
    return true;
  };
  return add(0.0, 1.0, steps.along, steps.along) && add(1.0, 0.0, steps.before, steps.after);
}

template <class Evaluate>
double MultibodyDifferenceJacobian::move(const double* values, int j, std::vector<double>& moved,
                                         CallbackError& error, Evaluate evaluate) {
  const int count = static_cast<int>(moved.size());
  const double unit = unit_of_component(values, count, j);
  for (const double wanted : {increment * unit, -increment * unit}) {
    std::copy_n(values, count, moved.data());
    moved[index(j)] += wanted;
    error = {};
    if (evaluate()) return moved[index(j)] - values[j];
    if (!error.is_recoverable()) return 0.0;
  }
  return 0.0;
}

bool MultibodyDifferenceJacobian::position_column(const Point& point, int j, MultibodyJacobian& jacobian,
                                                  CallbackError& error) {
  const MultibodyArguments moved{point.at.t, moved_q_.data(), point.at.v};
  const auto evaluate = [&] { return residuals(moved, point.a, point.mu, moved_, error); };
  const double offset = move(point.at.q, j, moved_q_, error, evaluate);
  if (offset == 0.0) return false;
  const auto column = [j](Matrix& matrix) { return matrix.view().columns(j, 1); };
  write_quotient(moved_.force, base_.force, offset, column(jacobian.force_q));
  if (functions_.has_kinematics())
    write_quotient(moved_.kinematics, base_.kinematics, offset, column(jacobian.kinematics_q));
  if (functions_.sizes().constraints() == 0) return true;
  write_quotient(moved_.acceleration, base_.acceleration, offset, column(jacobian.acceleration_q));
  write_quotient(moved_.velocity, base_.velocity, offset, column(jacobian.velocity_q));
  return !curvature_.is_needed() || add_rough_column(point, j, offset, column(jacobian.acceleration_q), error);
}

// offset: that of moved_. Rows of s that are differences need a larger one.
bool MultibodyDifferenceJacobian::add_rough_column(const Point& point, int j, double offset, View column,
                                                   CallbackError& error) {
  const double* const q = point.at.q;
  const double wide = std::copysign(wide_increment * unit_of_component(q, functions_.sizes().positions, j), offset);
  moved_q_[index(j)] = q[j] + wide;
  for (std::size_t i = 0; i < direction_.size(); ++i)
    direction_[i] = base_.kinematics[i] + (moved_.kinematics[i] - base_.kinematics[i]) * (wide / offset);
  const MultibodyArguments moved{point.at.t, moved_q_.data(), point.at.v};
  if (!curvature_.rough(moved, direction_, point.steps, rough_moved_.data(), error)) return false;
  for (int i = 0; i < column.rows; ++i) column(i, 0) += (rough_moved_[index(i)] - rough_base_[index(i)]) / wide;
  return true;
}

bool MultibodyDifferenceJacobian::velocity_column(const MultibodyArguments& at, int j,
                                                  const std::vector<double>& forces, View force_v,
                                                  CallbackError& error) {
  const MultibodyArguments moved{at.t, at.q, moved_v_.data()};
  const auto evaluate = [&] { return functions_.forces(moved, moved_.force.data(), error); };
  const double offset = move(at.v, j, moved_v_, error, evaluate);
  if (offset == 0.0) return false;
  write_quotient(moved_.force, forces, offset, force_v.columns(j, 1));
  return true;
}

bool MultibodyDifferenceJacobian::evaluate(const MultibodyState& state, const MultibodyTerms& terms,
                                           MultibodyJacobian& jacobian, CallbackError& error) {
  const auto [t, q, v, a, mu] = state;
  const MultibodyArguments at{t, q, v};
  const int nq = functions_.sizes().positions, nv = functions_.sizes().velocities,
            rows = functions_.sizes().constraints();
  if (functions_.has_kinematics() && jacobian.kinematics_q.cols() == 0) jacobian.kinematics_q = Matrix(nq, nq);
  if (!residuals(at, a, mu, base_, error)) return false;
  direction_ = base_.kinematics;
  // Finds the spacings that are accurate here; the values are overwritten.
  if (curvature_.is_needed() && !curvature_.add(at, terms.S, rough_base_.data(), error)) return false;
  const Point point{at, a, mu, curvature_.rough_increments(t, rough_spacing)};
  const View acceleration_v = jacobian.acceleration_v;
  fill(acceleration_v, 0.0);
  const MultibodyIncrements steps =
      increments_at(t, spacing * time_of_motion(q, direction_), spacing * unit_of_time(t), functions_);
  if (rows > 0 && !add_rate_of_C(at, steps, acceleration_v, error)) return false;
  if (curvature_.is_needed() && !curvature_.rough(at, direction_, point.steps, rough_base_.data(), error))
    return false;
  for (int j = 0; j < nq; ++j)
    if (!position_column(point, j, jacobian, error)) return false;
  for (int j = 0; j < nv; ++j)
    if (!velocity_column(at, j, terms.f, jacobian.force_v, error)) return false;
  if (rows == 0) return true;
  if (functions_.has_kinematics()) {
    multiply(1.0, Op::plain, jacobian.velocity_q, Op::plain, terms.S, 1.0, acceleration_v);
  } else {
    for (int j = 0; j < nv; ++j)
      for (int i = 0; i < rows; ++i) acceleration_v(i, j) += jacobian.velocity_q(i, j);
  }
  return true;
}

}  // namespace sfdae::core
