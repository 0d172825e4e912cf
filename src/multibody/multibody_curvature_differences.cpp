// gamma and eta of a mechanical system whose functions do not supply them.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_curvature_differences.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int points = DifferenceFormula::points;
// Initial spacing; nine points at this distance are exact to roundoff for a sine.
constexpr double widest_spacing = 1.0 / 16.0;
constexpr int spacings = 12;  // each a fourth of the one before: down to 1.5e-8
// Error of the formula with two points fewer: the one in use is better by the square of the spacing
// (docs/design/finite_differences.md).
constexpr double good_error = 1e-9;
// Weights of the formula times rounding errors of sums in the functions; no figures were recorded.
constexpr double formula_roundoff = 100.0 * unit_roundoff;

}  // namespace

// Components that are much smaller than others may be zero by chance, so the unit is at least a hundredth of the
// largest.
double unit_of_component(const double* values, int count, int j) {
  const double largest = max_abs(values, count);
  return largest == 0.0 ? 1.0 : std::max(std::fabs(values[j]), 1e-2 * largest);
}

double time_of_motion(const double* q, const std::vector<double>& direction) {
  const int nq = static_cast<int>(direction.size());
  double step = infinity;
  for (int j = 0; j < nq; ++j)
    if (direction[index(j)] != 0.0)
      step = std::min(step, std::min(1.0, unit_of_component(q, nq, j)) / std::fabs(direction[index(j)]));
  return step;
}

MultibodyIncrements increments_at(double t, double along, double in_time, const MultibodyFunctions& functions) {
  MultibodyIncrements steps{along < infinity ? along : 0.0, 0.0, 0.0};
  if (functions.may_depend_on_time()) {
    steps.before = std::min(in_time, std::max(functions.room(t, -1.0), 0.0));
    steps.after = std::min(in_time, std::max(functions.room(t, 1.0), 0.0));
  }
  return steps;
}

CurvatureDifferences::CurvatureDifferences(const MultibodyFunctions& functions)
    : functions_(functions),
      gamma_(functions.sizes().holonomic > 0 && functions.given().constraint_curvature == nullptr),
      eta_(functions.sizes().nonholonomic > 0 && functions.given().nonholonomic_curvature == nullptr),
      g_q_(functions.sizes().holonomic, functions.sizes().positions),
      H_(functions.sizes().nonholonomic, functions.sizes().velocities),
      direction_(index(functions.sizes().positions)),
      shifted_q_(direction_),
      shifted_direction_(direction_) {
  const std::size_t rows = index(functions.sizes().constraints());
  for (int shift = 0; shift < points; ++shift) formulas_.emplace_back(shift, 1);
  samples_.resize(rows * points);
  for (auto* values : {&values_, &errors_, &along_, &in_time_}) values->resize(rows);
}

// The rows of C v + r whose derivatives along the motion are not given; 0 in others.
bool CurvatureDifferences::residuals(const MultibodyArguments& at, double* values, CallbackError& error) {
  const MultibodySizes& sizes = functions_.sizes();
  double *const g_1 = values, *const h = values + sizes.holonomic;
  std::fill_n(values, sizes.constraints(), 0.0);
  if (gamma_) {
    if (!functions_.kinematics(at, S_, error) || !functions_.constraint_derivatives(at, g_q_, g_1, error))
      return false;
    functions_.velocity(S_, at.v, shifted_direction_.data());
    multiply(1.0, Op::plain, g_q_, shifted_direction_.data(), 1.0, g_1);
  }
  if (!eta_) return true;
  if (!functions_.nonholonomic(at, H_, h, error)) return false;
  multiply(1.0, Op::plain, H_, at.v, 1.0, h);
  return true;
}

bool CurvatureDifferences::residuals_beside(const MultibodyArguments& at, const Line& line, double offset,
                                            double* values, CallbackError& error) {
  std::copy_n(at.q, shifted_q_.size(), shifted_q_.data());
  for (std::size_t i = 0; i < shifted_q_.size(); ++i) shifted_q_[i] += offset * line.q_rate * line.direction[i];
  return residuals({at.t + offset * line.t_rate, shifted_q_.data(), at.v}, values, error);
}

// False if a row is not accurate enough yet at this spacing. Each row is tested separately, as units may differ.
bool CurvatureDifferences::improve(int shift, double step, double* derivative) {
  bool done = true;
  for (std::size_t row = 0; row < errors_.size(); ++row) {
    const double* const samples = samples_.data() + row * points;
    double value = 0.0, error = 0.0;
    formulas_[index(shift)].apply(1, step, samples, 1, &value, &error);
    if (error < errors_[row]) derivative[row] = value;
    errors_[row] = std::min(errors_[row], error);
    const double roundings = formula_roundoff * max_abs(samples, points) / step;
    if (error > std::max(good_error * std::fabs(value), roundings)) done = false;
  }
  return done;
}

// line.step becomes the spacing that was accurate.
bool CurvatureDifferences::differentiate(const MultibodyArguments& at, Line& line, double* derivative,
                                         CallbackError& callback_error) {
  double wanted = line.step;
  CallbackError last;
  std::fill(errors_.begin(), errors_.end(), infinity);
  for (int attempt = 0; attempt < spacings; ++attempt, wanted /= 4.0) {
    double step = wanted;
    const int shift = fitting_shift(line.below, line.above, step);
    last = {};
    for (int i = 0; i < points && last.status == SFDAE_OK; ++i) {
      residuals_beside(at, line, (i - shift) * step, values_.data(), last);
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

bool CurvatureDifferences::add(const MultibodyArguments& at, const Matrix& S, double* s, CallbackError& error) {
  functions_.velocity(S, at.v, direction_.data());
  std::fill(along_.begin(), along_.end(), 0.0);
  std::fill(in_time_.begin(), in_time_.end(), 0.0);
  Line along{0.0, 1.0, direction_, widest_spacing * time_of_motion(at.q, direction_), infinity, infinity};
  good_step_ = 0.0;
  if (along.step < infinity) {
    if (!differentiate(at, along, along_.data(), error)) return false;
    good_step_ = along.step;
  }
  const double before = std::max(functions_.room(at.t, -1.0), 0.0), after = std::max(functions_.room(at.t, 1.0), 0.0);
  Line in_time{1.0, 0.0, direction_, widest_spacing * unit_of_time(at.t), before, after};
  good_time_ = 0.0;
  if (functions_.may_depend_on_time() && before + after > 0.0) {
    if (!differentiate(at, in_time, in_time_.data(), error)) return false;
    good_time_ = in_time.step;
  }
  for (std::size_t i = 0; i < along_.size(); ++i) s[i] += along_[i] + in_time_[i];
  return true;
}

bool CurvatureDifferences::rough(const MultibodyArguments& at, const std::vector<double>& direction,
                                 const MultibodyIncrements& steps, double* s, CallbackError& error) {
  std::fill_n(s, along_.size(), 0.0);
  const auto add_quotient = [&](const Line& line, double before, double after) {
    if (before + after == 0.0) return true;
    if (!residuals_beside(at, line, after, along_.data(), error) ||
        !residuals_beside(at, line, -before, in_time_.data(), error))
      return false;
    for (std::size_t i = 0; i < along_.size(); ++i) s[i] += (along_[i] - in_time_[i]) / (before + after);
    return true;
  };
  return add_quotient({0.0, 1.0, direction, 0.0, 0.0, 0.0}, steps.along, steps.along) &&
         add_quotient({1.0, 0.0, direction, 0.0, 0.0, 0.0}, steps.before, steps.after);
}

}  // namespace sfdae::core
