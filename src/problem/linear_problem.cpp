// The user's functions E, A, f of a linear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/linear_problem.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/differences.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Formulas of nine points give six orders with an accuracy worth having.
constexpr int max_difference_order = 6;
// Steps tried, from a sixteenth of the interval of interest down by halves to 1e-9 of it; by judgement.
constexpr double widest_step = 1.0 / 16.0;
constexpr int difference_steps = 24;

double largest_entry(const double* values, int count) { return max_abs({values, count, 1, std::max(count, 1)}); }

}  // namespace

LinearProblem::LinearProblem(LinearFunctions user)
    : user_(std::move(user)),
      functions_{Function{'E', m(), n(), user_.constant_E, 0, std::numeric_limits<int>::max(), 0.0, {}},
                 Function{'A', m(), n(), user_.constant_A, 0, std::numeric_limits<int>::max(), 0.0, {}},
                 Function{'f', m(), 1, user_.f == nullptr, 0, std::numeric_limits<int>::max(), 0.0, {}}} {}

void LinearProblem::set_differences(const DifferenceOptions& options) {
  differences_ = options;
  for (Function& function : functions_) {
    function.difference_step = 0.0;
    function.highest_order = std::numeric_limits<int>::max();
  }
}

void LinearProblem::archive(Archive& archive) {
  bool has_scale = !units_.are_one();
  archive.small(has_scale);
  if (has_scale) archive.reals(units_.values(), index(n()));
  else if (archive.is_reading()) units_ = {};
  if (!differences_.allowed) return;
  for (double* value : {&differences_.span, &lowest_t_, &highest_t_}) archive.real(*value);
  for (Function& function : functions_) archive.real(function.difference_step);
}

CallbackError LinearProblem::call(char which, double t, int order, double* values) {
  Function& function = functions_[slot(which)];
  const int count = function.rows * function.columns;
  std::fill_n(values, count, 0.0);
  CallbackError callback_error;
  callback_error.function = function.name == 'E' ? "E" : function.name == 'A' ? "A" : "f";
  callback_error.order = order;
  callback_error.t = t;
  callback_error.user_t = user_t();
  if (stop_is_requested()) {
    callback_error.status = SFDAE_STOPPED;
    return callback_error;
  }
  if (which == 'f' && user_.f == nullptr) return callback_error;
  ++function.calls;
  callback_error.code = which == 'E'   ? user_.E(t, order, values, user_.user)
                        : which == 'A' ? user_.A(t, order, values, user_.user)
                                       : user_.f(t, order, values, user_.user);
  if (callback_error.code != 0) {
    callback_error.status = callback_error.code < 0                            ? SFDAE_CALLBACK_STOPPED
                            : callback_error.code == SFDAE_ORDER_NOT_AVAILABLE ? SFDAE_ORDER_MISSING
                                                                               : SFDAE_CALLBACK_FAILED;
    if (explanation_ && callback_error.status == SFDAE_CALLBACK_FAILED) {
      callback_error.status = SFDAE_NOT_FINITE;
      callback_error.detail =
          "the equations cannot be evaluated at " + callback_error.where() + ": " + explanation_() + ".";
    }
    return callback_error;
  }
  if (!all_finite(values, index(count))) {
    callback_error.status = SFDAE_NOT_FINITE;
    int first = 0;
    while (all_finite(values + first, 1)) ++first;
    callback_error.row = first % function.rows;
    callback_error.column = first / function.rows;
  }
  return callback_error;
}

// All orders 0..order of one function, errors[k] that of differences relative to the largest value of its order.
CallbackError LinearProblem::fill(Function& function, double t, int order, double* values, double* errors) {
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(function.rows) * function.columns;
  std::fill_n(errors, max_derivative_order + 1, 0.0);
  if (function.constant) {
    if (function.constant_value.empty()) {
      std::vector<double> value(static_cast<std::size_t>(count));
      const CallbackError callback_error = call(function.name, t, 0, value.data());
      if (callback_error.status != SFDAE_OK) return callback_error;
      function.constant_value = value;
    }
    std::copy(function.constant_value.begin(), function.constant_value.end(), values);
    std::fill_n(values + count, count * order, 0.0);
    return {};
  }
  for (int k = 0; k <= order; ++k) {
    CallbackError callback_error;
    if (k <= function.highest_order) {
      callback_error = call(function.name, t, k, values + count * k);
      if (callback_error.status == SFDAE_OK) continue;
      if (callback_error.status != SFDAE_ORDER_MISSING) return callback_error;
      if (k > 0 && differences_.allowed) function.highest_order = k - 1;
    }
    if (!differences_.allowed || k == 0 || order > max_difference_order) {
      if (callback_error.status == SFDAE_OK) {
        callback_error.status = SFDAE_ORDER_MISSING;
        callback_error.function = function.name == 'E' ? "E" : function.name == 'A' ? "A" : "f";
        callback_error.order = k;
        callback_error.t = t;
        callback_error.user_t = user_t();
      }
      return callback_error;
    }
    return differentiate(function, t, {k, order}, values, errors);
  }
  return {};
}

CallbackError LinearProblem::sample(Function& function, double t, double& step, std::vector<double>& samples,
                                    int& shift) {
  constexpr int points = DifferenceFormula::points;
  const int count = function.rows * function.columns;
  // Centred, or moved so that all points lie within the limits, which may be closer than the points.
  const double below = std::max(t - lowest_t_, 0.0), above = std::max(highest_t_ - t, 0.0);
  shift = fitting_shift(below, above, step);
  samples.resize(index(points) * index(count));
  for (int i = 0; i < points; ++i) {
    const CallbackError callback_error =
        call(function.name, t + (i - shift) * step, 0, samples.data() + static_cast<std::ptrdiff_t>(i) * count);
    if (callback_error.status != SFDAE_OK) return callback_error;
  }
  return {};
}

// Halves the step while the worst relative error of the derivatives falls.
CallbackError LinearProblem::choose_difference_step(Function& function, double t, int last) {
  if (differences_.step > 0.0) {
    function.difference_step = differences_.step;
    return {};
  }
  const int count = function.rows * function.columns;
  std::vector<double> samples, derivative(index(count));
  double best_error = std::numeric_limits<double>::infinity();
  double wanted = differences_.span * widest_step;
  CallbackError callback_error, last_error;
  for (int attempt = 0; attempt < difference_steps; ++attempt, wanted /= 2.0) {
    int shift = 0;
    double step = wanted;
    callback_error = sample(function, t, step, samples, shift);
    if (callback_error.status == SFDAE_CALLBACK_STOPPED || callback_error.status == SFDAE_STOPPED)
      return callback_error;
    if (callback_error.status != SFDAE_OK) {
      last_error = callback_error;
      continue;  // the points reach out of the domain of the function
    }
    const DifferenceFormula formula(shift, last);
    double worst = 0.0, size = largest_entry(samples.data(), DifferenceFormula::points * count);
    if (size == 0.0) size = 1.0;
    // Errors of different orders are compared in the time in which the function changes by its own size.
    double unit = differences_.span;
    for (int k = 1; k <= last; ++k) {
      double error = 0.0;
      formula.apply(k, step, samples.data(), count, derivative.data(), &error);
      if (k == 1) unit = std::min(unit, size / std::max(largest_entry(derivative.data(), count), size / unit));
      worst = std::max(worst, error * std::pow(unit, k) / size);
    }
    if (worst < best_error) {
      best_error = worst;
      function.difference_step = step;
    }
  }
  return function.difference_step > 0.0 ? CallbackError{} : last_error;
}

CallbackError LinearProblem::differentiate(Function& function, double t, OrderRange orders, double* values,
                                           double* errors) {
  const auto [first, last] = orders;
  const int count = function.rows * function.columns;
  if (function.difference_step == 0.0) {
    const CallbackError callback_error = choose_difference_step(function, t, last);
    if (callback_error.status != SFDAE_OK) return callback_error;
  }
  std::vector<double> samples;
  int shift = 0;
  double step = function.difference_step;
  const CallbackError callback_error = sample(function, t, step, samples, shift);
  if (callback_error.status != SFDAE_OK) return callback_error;
  const DifferenceFormula formula(shift, last);
  const double size = largest_entry(samples.data(), static_cast<int>(samples.size()));
  for (int k = first; k <= last; ++k) {
    double* derivative = values + static_cast<std::ptrdiff_t>(count) * k;
    double error = 0.0;
    formula.apply(k, step, samples.data(), count, derivative, &error);
    // Values below the error are none: a constant matrix keeps derivatives that are exactly zero.
    for (int i = 0; i < count; ++i)
      if (std::fabs(derivative[i]) <= error) derivative[i] = 0.0;
    errors[k] = size > 0.0 ? error / size : 0.0;
  }
  return {};
}

CallbackError LinearProblem::evaluate_plain(double t, Orders orders, TaylorData& data) {
  data.resize(m(), n(), orders);
  data.t = t;
  CallbackError callback_error;
  if (orders.E >= 0) callback_error = fill(functions_[0], t, orders.E, data.E(0).data, data.error_E.data());
  if (callback_error.status == SFDAE_OK && orders.A >= 0)
    callback_error = fill(functions_[1], t, orders.A, data.A(0).data, data.error_A.data());
  if (callback_error.status == SFDAE_OK && orders.f >= 0)
    callback_error = fill(functions_[2], t, orders.f, data.f(0), data.error_f.data());
  return callback_error;
}

CallbackError LinearProblem::evaluate(double t, Orders orders, double time_scale, TaylorData& data, RowScaling rows,
                                      const std::vector<double>* preferred_rows) {
  CallbackError callback_error = evaluate_plain(t, orders, data);
  if (callback_error.status == SFDAE_OK && !units_.are_one()) data.scale_columns(units_);
  if (callback_error.status == SFDAE_OK && !data.scale(time_scale, rows, preferred_rows)) {
    callback_error.status = SFDAE_NOT_FINITE;
    callback_error.row = -1;
    callback_error.t = t;
    callback_error.user_t = user_t();
  }
  return callback_error;
}

CallbackError LinearProblem::evaluate_prescribed(double t, double* values) {
  const int count = static_cast<int>(prescribed().size());
  CallbackError callback_error;
  if (count == 0) return callback_error;
  std::fill_n(values, count, 0.0);
  callback_error.function = "prescribed_values";
  callback_error.t = t;
  callback_error.user_t = user_t();
  callback_error.code = user_.inputs.values(t, 0, values, user_.inputs.user);
  if (callback_error.code != 0)
    callback_error.status = callback_error.code < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED;
  else if (!all_finite(values, index(count))) callback_error.status = SFDAE_NOT_FINITE;
  return callback_error;
}

}  // namespace sfdae::core
