// Derivatives of a mechanical system that its functions do not give.
//
// s = d/ds (C v + r) along (t + s, q + s S v) with v held: differences of nine points, of t and of q apart, so that
// what limits t has no influence on systems that do not depend on it.
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

constexpr int points = DifferenceFormula::points;
// Points to begin with; nine of them at this distance are exact to rounding for a sine.
constexpr double widest_spacing = 1.0 / 16.0;
constexpr int spacings = 12;  // each a fourth of the one before
// Of the formula with two points less: the one in use is better by the square of the spacing.
constexpr double good_error = 1e-9;

}  // namespace

double CallbackMultibody::unit_of(const double* values, int count, int j) {
  const double largest = max_abs(values, count);
  return largest == 0.0 ? 1.0 : std::max(std::fabs(values[j]), 1e-2 * largest);
}

double CallbackMultibody::unit_of_time(double t) { return std::max(1.0, 1e-3 * std::fabs(t)); }

void CallbackMultibody::velocity_of(const Matrix& S, const double* v, double* velocity) const {
  if (has_kinematics()) multiply(1.0, Op::plain, S, v, 0.0, velocity);
  else std::copy_n(v, sizes().positions, velocity);
}

bool CallbackMultibody::undifferentiated(const Point& at, double* values, CallbackError& callback_error) {
  const int nl = sizes().holonomic, nk = sizes().nonholonomic;
  const View g_t{values, nl, 1, std::max(nl, 1)}, h{values + nl, nk, 1, std::max(nk, 1)};
  std::fill_n(values, sizes().constraints(), 0.0);
  if (gamma_by_differences_) {
    if (has_kinematics()) {
      if (probe_.S.cols() == 0) probe_.S = Matrix(sizes().positions, sizes().velocities);
      if (!call("kinematics", functions_.kinematics, at, probe_.S, callback_error)) return false;
    }
    if (!call("constraint_jacobian", functions_.constraint_jacobian, at, probe_.g_q, callback_error) ||
        !call("constraint_rate", functions_.constraint_rate, at, g_t, callback_error))
      return false;
    velocity_of(probe_.S, at.v, shifted_direction_.data());
    multiply(1.0, Op::plain, probe_.g_q, shifted_direction_.data(), 1.0, g_t.data);
  }
  if (!eta_by_differences_) return true;
  if (!call("nonholonomic_matrix", functions_.nonholonomic_matrix, at, H_, callback_error) ||
      !call("nonholonomic_offset", functions_.nonholonomic_offset, at, h, callback_error))
    return false;
  multiply(1.0, Op::plain, H_, at.v, 1.0, h.data);
  return true;
}

// direction_ is S v.
bool CallbackMultibody::at_offset(const Point& at, const Line& line, double offset, double* values,
                                  CallbackError& callback_error) {
  std::copy_n(at.q, sizes().positions, shifted_q_.data());
  for (std::size_t i = 0; i < shifted_q_.size(); ++i) shifted_q_[i] += offset * line.q_rate * direction_[i];
  return undifferentiated({at.t + offset * line.t_rate, shifted_q_.data(), at.v}, values, callback_error);
}

// False if a row is not accurate enough yet at this spacing. Rows are judged by themselves: their units may differ.
bool CallbackMultibody::improve(int shift, double step, double* derivative) {
  bool done = true;
  for (std::size_t row = 0; row < errors_.size(); ++row) {
    const double* const samples = samples_.data() + row * points;
    double value = 0.0, error = 0.0;
    formulas_[index(shift)].apply(1, step, samples, 1, &value, &error);
    if (error < errors_[row]) derivative[row] = value;
    errors_[row] = std::min(errors_[row], error);
    const double rounding = 100.0 * unit_roundoff * max_abs(samples, points) / step;
    if (error > std::max(good_error * std::fabs(value), rounding)) done = false;
  }
  return done;
}

bool CallbackMultibody::differentiate(const Point& at, Line& line, double* derivative,
                                      CallbackError& callback_error) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double wanted = line.step;
  CallbackError last;
  std::fill(errors_.begin(), errors_.end(), infinity);
  for (int attempt = 0; attempt < spacings; ++attempt, wanted /= 4.0) {
    double step = wanted;
    const int shift = fitting_shift(line.below, line.above, step);
    last = {};
    for (int i = 0; i < points && last.status == SFDAE_OK; ++i) {
      at_offset(at, line, (i - shift) * step, values_.data(), last);
      for (std::size_t row = 0; row < values_.size(); ++row) samples_[row * points + index(i)] = values_[row];
    }
    if (last.status != SFDAE_OK && !last.is_recoverable()) break;
    if (last.status != SFDAE_OK) continue;  // out of the domain of a function: closer points
    line.step = step;
    if (improve(shift, step, derivative)) break;
  }
  const bool found = errors_.front() < infinity;
  if (found && (last.status == SFDAE_OK || last.is_recoverable())) return true;
  callback_error = last;
  return false;
}

// In which no position moves by more than its size; angles bend within 1.
double CallbackMultibody::step_along_motion(const double* q) const {
  const int nq = sizes().positions;
  double step = std::numeric_limits<double>::infinity();
  for (int j = 0; j < nq; ++j)
    if (direction_[index(j)] != 0.0)
      step = std::min(step, std::min(1.0, unit_of(q, nq, j)) / std::fabs(direction_[index(j)]));
  return step;
}

bool CallbackMultibody::add_differences(const Point& at, const MultibodyTerms& terms, double* s,
                                        CallbackError& callback_error) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const int rows = sizes().constraints();
  velocity_of(terms.S, at.v, direction_.data());
  std::fill(along_.begin(), along_.end(), 0.0);
  std::fill(in_time_.begin(), in_time_.end(), 0.0);
  Line along{0.0, 1.0, widest_spacing * step_along_motion(at.q), infinity, infinity};
  good_step_ = 0.0;
  if (along.step < infinity) {
    if (!differentiate(at, along, along_.data(), callback_error)) return false;
    good_step_ = along.step;
  }
  const double before = std::max(room(at.t, -1.0), 0.0), after = std::max(room(at.t, 1.0), 0.0);
  Line in_time{1.0, 0.0, widest_spacing * unit_of_time(at.t), before, after};
  good_time_ = 0.0;
  if (may_depend_on_time() && before + after > 0.0) {
    if (!differentiate(at, in_time, in_time_.data(), callback_error)) return false;
    good_time_ = in_time.step;
  }
  for (int i = 0; i < rows; ++i) s[i] += along_[index(i)] + in_time_[index(i)];
  return true;
}

}  // namespace sfdae::core
