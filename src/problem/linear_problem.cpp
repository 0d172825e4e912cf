// The user's functions E, A, f of a linear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/linear_problem.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/chebyshev_differences.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Polynomials of degree 12 give six orders of useful accuracy.
constexpr int max_difference_order = 6;
// Steps tried, from about a sixteenth of the interval of interest, but no simple fraction of it, which may be that of
// a period, down by halves to 1e-9 of it; by judgement.
constexpr double widest_step = 0.93 / 16.0;
constexpr int difference_steps = 24;

// Number of rows up to which a factorization is as cheap as its retrieval (docs/design/derivative_array.md).
constexpr int quickly_factored = 12;

// Half the interval of the points, in spacings: those in the middle, the widest ones, are 1.04 apart.
constexpr double steps_in_half_width = 4.0;

// Relative position in [-1, 1].
double position_in(double middle, double half_width, double t) {
  return std::clamp((t - middle) / half_width, -1.0, 1.0);
}

double* values_of(TaylorData& data, char which) {
  return which == 'E' ? data.E(0).data : which == 'A' ? data.A(0).data : data.f(0);
}

}  // namespace

LinearProblem::LinearProblem(LinearFunctions user)
    : user_(std::move(user)),
      functions_{Function{'E', m(), n(), user_.constant_E, 0, std::numeric_limits<int>::max(), {}, {}},
                 Function{'A', m(), n(), user_.constant_A, 0, std::numeric_limits<int>::max(), {}, {}},
                 Function{'f', m(), 1, user_.f == nullptr, 0, std::numeric_limits<int>::max(), {}, {}}} {
  set_equation_names(user_.names);
}

void LinearProblem::set_differences(const DifferenceOptions& options) {
  differences_ = options;
  for (Function& function : functions_) {
    function.spacings = {};
    function.highest_order = std::numeric_limits<int>::max();
  }
}

LinearProblem::Settings LinearProblem::settings() const {
  Settings settings{units_, differences_, {}, {}, lowest_t_, highest_t_};
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    settings.highest_orders[i] = functions_[i].highest_order;
    settings.spacings[i] = functions_[i].spacings;
  }
  return settings;
}

void LinearProblem::set_settings(Settings settings) {
  units_ = std::move(settings.units);
  differences_ = settings.differences;
  set_limits(settings.lowest_t, settings.highest_t);
  for (std::size_t i = 0; i < functions_.size(); ++i) {
    functions_[i].highest_order = settings.highest_orders[i];
    functions_[i].spacings = std::move(settings.spacings[i]);
  }
}

void LinearProblem::archive(Archive& archive) {
  bool has_scale = !units_.are_one();
  archive.small(has_scale);
  if (has_scale) archive.reals(units_.values(), index(n()));
  else if (archive.is_reading()) units_ = {};
  if (!differences_.allowed) return;
  for (double* value : {&differences_.span, &lowest_t_, &highest_t_}) archive.real(*value);
  for (Function& function : functions_) archive_spacings(archive, function);
}

void LinearProblem::archive_spacings(Archive& archive, Function& function) {
  Spacings& spacings = function.spacings;
  int count = static_cast<int>(spacings.steps.size());
  archive.small(spacings.highest, count);
  if (archive.is_reading() && (count < 0 || (count == 0 && spacings.highest > 0))) throw DamagedArchive();
  archive.reals(spacings.steps, index(count));
  const std::size_t entries = count < 2 ? 0 : index(function.rows) * index(function.columns);
  spacings.of_entry.resize(entries);
  for (int& number : spacings.of_entry) {
    archive.small(number);
    if (number < 0 || number >= count) throw DamagedArchive();
  }
}

// compressed: the values of the pattern are requested, else all entries of a matrix.
CallbackError LinearProblem::invoke(char which, double t, int order, double* values,
                                    const ColumnPattern* compressed) {
  Function& function = functions_[slot(which)];
  const int count = compressed != nullptr ? compressed->entries() : function.rows * function.columns;
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
  ++(is_checking_ ? check_evaluations_ : function.calls);
  callback_error.code = which == 'E'   ? user_.E(t, order, values, user_.user)
                        : which == 'A' ? user_.A(t, order, values, user_.user)
                                       : user_.f(t, order, values, user_.user);
  if (callback_error.code != 0) {
    callback_error.status = callback_error.code < 0                            ? SFDAE_CALLBACK_STOPPED
                            : callback_error.code == SFDAE_ORDER_NOT_AVAILABLE ? SFDAE_ORDER_MISSING
                                                                               : SFDAE_CALLBACK_FAILED;
    if (explanation_ && callback_error.status != SFDAE_ORDER_MISSING) {
      if (callback_error.status == SFDAE_CALLBACK_FAILED) callback_error.status = SFDAE_NOT_FINITE;
      callback_error.detail =
          "the equations cannot be evaluated at " + callback_error.where() + ": " + explanation_() + ".";
    }
    return callback_error;
  }
  if (!all_finite(values, index(count))) {
    callback_error.status = SFDAE_NOT_FINITE;
    int first = 0;
    while (all_finite(values + first, 1)) ++first;
    callback_error.names = &equation_names();
    callback_error.row = compressed != nullptr ? compressed->row[index(first)] : first % function.rows;
    callback_error.column = compressed != nullptr ? compressed->column_of(first) : first / function.rows;
    return callback_error;
  }
  if (const ColumnPattern* pattern = pattern_of(which); pattern != nullptr && compressed == nullptr) {
    const auto [row, column] = entry_beyond(*pattern, m(), values);
    if (row < 0) return callback_error;
    const double value = values[index(row) + index(m()) * index(column)];
    callback_error.status = SFDAE_WRONG_PATTERN;
    callback_error.detail =
        lacking_entry(callback_error.function, equation_names().row(row), column, value, callback_error.where());
  }
  return callback_error;
}

// Null for f, and if there is no pattern.
const ColumnPattern* LinearProblem::pattern_of(char which) const {
  if (which == 'f' || !user_.patterns) return nullptr;
  return which == 'E' ? &user_.patterns->F_xdot : &user_.patterns->F_x;
}

void LinearProblem::keep_values(double t) {
  kept_ = std::make_unique<KeptPoint>();
  kept_->t = t;
  kept_factorizations_.start_keeping(kept_->memory);
}

void LinearProblem::forget_values() {
  kept_factorizations_.stop_keeping();
  kept_.reset();
}

CallbackError LinearProblem::call(char which, double t, int order, double* values) {
  if (!keeps_values_at(t) || order > max_derivative_order || stop_is_requested())
    return call_now(which, t, order, values);
  const Function& function = functions_[slot(which)];
  const std::size_t count = index(function.rows) * index(function.columns);
  double*& kept = kept_->values[slot(which)][index(order)];
  if (kept != nullptr) {
    std::copy_n(kept, count, values);
    return {};
  }
  const CallbackError error = call_now(which, t, order, values);
  if (error.status != SFDAE_OK) return error;
  kept = kept_->memory.take(count);
  std::copy_n(values, count, kept);
  return error;
}

CallbackError LinearProblem::call_now(char which, double t, int order, double* values) {
  if (which == 'f' || !user_.compressed) return invoke(which, t, order, values, nullptr);
  const ColumnPattern& pattern = *pattern_of(which);
  std::vector<double> entries(index(pattern.entries()));
  const CallbackError error = invoke(which, t, order, entries.data(), &pattern);
  if (error.status == SFDAE_OK) scatter(pattern, entries.data(), m(), values);
  return error;
}

CallbackError LinearProblem::call_entries(char which, double t, int order, double* values) {
  const ColumnPattern& pattern = *pattern_of(which);
  if (user_.compressed) return invoke(which, t, order, values, &pattern);
  std::vector<double> matrix(index(m()) * index(n()));
  const CallbackError error = invoke(which, t, order, matrix.data(), nullptr);
  if (error.status == SFDAE_OK) gather(pattern, matrix.data(), m(), values);
  return error;
}

// All orders 0..order of one function, with the errors of differences.
CallbackError LinearProblem::fill(Function& function, double t, int order, TaylorData& data) {
  double* values = values_of(data, function.name);
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(function.rows) * function.columns;
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
    return differentiate(function, t, {k, order}, data);
  }
  return {};
}

// Centred, or moved so that all points lie within the limits, which may be closer than the points.
LinearProblem::Interval LinearProblem::interval_about(double t, double step) const {
  const double below = std::max(t - lowest_t_, 0.0), above = std::max(highest_t_ - t, 0.0);
  const double half_width = std::min(steps_in_half_width * step, (below + above) / 2.0);
  double middle = t;
  if (above < half_width) middle = highest_t_ - half_width;
  if (below < half_width) middle = lowest_t_ + half_width;
  return {middle, half_width};
}

double LinearProblem::time_in(const Interval& interval, double position) const {
  return std::clamp(interval.middle + interval.half_width * position, lowest_t_, highest_t_);
}

CallbackError LinearProblem::sample(Function& function, const Interval& interval, std::vector<double>& samples) {
  constexpr int points = ChebyshevDifferences::points;
  const int count = function.rows * function.columns;
  samples.resize(index(points) * index(count));
  for (int i = 0; i < points; ++i) {
    const CallbackError callback_error = call(function.name, time_in(interval, ChebyshevDifferences::node(i)), 0,
                                              samples.data() + static_cast<std::ptrdiff_t>(i) * count);
    if (callback_error.status != SFDAE_OK) return callback_error;
  }
  return {};
}

// Tries steps that are halved each time.
CallbackError LinearProblem::choose_spacings(Function& function, double t, int last) {
  if (differences_.step > 0.0) {
    function.spacings = {last, {differences_.step}, {}};
    return {};
  }
  const int count = function.rows * function.columns;
  std::vector<double> samples, probe(index(count));
  SpacingSearch search(count, last, differences_.span);
  CallbackError last_error;
  double wanted = differences_.span * widest_step;
  for (int attempt = 0; attempt < difference_steps; ++attempt, wanted /= 2.0) {
    const Interval interval = interval_about(t, wanted);
    CallbackError callback_error = sample(function, interval, samples);
    if (callback_error.status == SFDAE_OK)
      callback_error = call(function.name, time_in(interval, ChebyshevDifferences::probe()), 0, probe.data());
    if (callback_error.status == SFDAE_CALLBACK_STOPPED || callback_error.status == SFDAE_STOPPED)
      return callback_error;
    if (callback_error.status == SFDAE_OK)
      search.add(wanted, {interval.half_width, position_in(interval.middle, interval.half_width, t), samples.data(),
                          probe.data()});
    else last_error = callback_error;  // the points reach out of the domain of the function
  }
  if (search.is_empty()) return last_error;
  function.spacings = search.choose();
  return {};
}

CallbackError LinearProblem::differentiate(Function& function, double t, OrderRange orders, TaylorData& data) {
  const auto [first, last] = orders;
  const int count = function.rows * function.columns;
  if (function.spacings.highest < last) {
    const CallbackError callback_error = choose_spacings(function, t, last);
    if (callback_error.status != SFDAE_OK) return callback_error;
  }
  const Spacings& spacings = function.spacings;
  std::vector<double> samples, derivative(index(count)), error(index(count));
  for (int number = 0; number < static_cast<int>(spacings.steps.size()); ++number) {
    const Interval interval = interval_about(t, spacings.steps[index(number)]);
    const CallbackError callback_error = sample(function, interval, samples);
    if (callback_error.status != SFDAE_OK) return callback_error;
    const ChebyshevDifferences differences(position_in(interval.middle, interval.half_width, t), last);
    for (int k = first; k <= last; ++k) {
      double* values = values_of(data, function.name) + static_cast<std::ptrdiff_t>(count) * k;
      double* errors = data.errors(function.name, k);
      differences.apply(k, interval.half_width, samples.data(), count, derivative.data(), error.data());
      for (int e = 0; e < count; ++e) {
        if (spacings.of(e) != number) continue;
        // Values below their own error become zero: a constant keeps derivatives that are exactly zero.
        values[e] = std::fabs(derivative[index(e)]) <= error[index(e)] ? 0.0 : derivative[index(e)];
        errors[e] = error[index(e)];
      }
    }
  }
  return {};
}

CallbackError LinearProblem::evaluate_plain(double t, Orders orders, TaylorData& data) {
  data.resize(m(), n(), orders);
  data.t = t;
  CallbackError callback_error;
  if (orders.E >= 0) callback_error = fill(functions_[0], t, orders.E, data);
  if (callback_error.status == SFDAE_OK && orders.A >= 0) callback_error = fill(functions_[1], t, orders.A, data);
  if (callback_error.status == SFDAE_OK && orders.f >= 0) callback_error = fill(functions_[2], t, orders.f, data);
  return callback_error;
}

CallbackError LinearProblem::evaluate(double t, Orders orders, double time_scale, TaylorData& data, RowScaling rows,
                                      const std::vector<double>* preferred_rows) {
  CallbackError callback_error = evaluate_plain(t, orders, data);
  const bool keeps_factorizations = keeps_values_at(t) && m() > quickly_factored;
  data.set_kept_factorizations(keeps_factorizations ? &kept_factorizations_ : nullptr);
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
