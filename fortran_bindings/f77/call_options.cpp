// Arguments and options of DGELDA and SFNDAE.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/call_options.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "integrate/step_control.h"
#include "linalg/index.h"

namespace sfdae::f77 {

namespace {

// The last position of RWORK that is an input.
constexpr int last_real_input = 15;

// Comparisons with NaN are false, and these ones raise no floating-point exception: all conditions are those of what
// is right.
bool is_positive(double value) { return std::isgreater(value, 0.0); }
bool is_tolerance(double value) { return std::isfinite(value) && value >= 0.0; }

double smallest_step(double t, double tout) {
  return 4.0 * std::numeric_limits<double>::epsilon() * std::max(std::fabs(t), std::fabs(tout));
}

int check_lengths(const Arguments& arguments, const Options& options) {
  const Lengths needed = arguments.routine->lengths(arguments, options);
  const bool rwork_too_short = static_cast<double>(arguments.lrw) < needed.rwork;
  if (!rwork_too_short && arguments.liw >= needed.iwork) return code::ok;
  if (arguments.liw >= 1) {
    const std::int64_t reals = static_cast<std::int64_t>(std::min(needed.rwork, 9e18));
    arguments.iwork.set(arguments.liw, rwork_too_short ? reals : needed.iwork);
  }
  return rwork_too_short ? code::short_rwork : code::short_iwork;
}

// MAXORD, MXINDX and the lengths that depend on them.
int read_sizes(const Arguments& arguments, bool is_first_call, Options& options) {
  // Where IWORK is too short to be read that is found out below.
  const bool is_readable = arguments.liw >= shortest_iwork;
  if (is_readable && (arguments.flag(9) || !is_first_call)) {
    const std::int64_t max_order = arguments.iwork.get(3);
    if (max_order < 1 || max_order > core::max_bdf_order) return code::bad_max_order;
    options.max_order = static_cast<int>(max_order);
  }
  if (is_readable && (arguments.flag(10) || !is_first_call)) {
    const std::int64_t max_index = arguments.iwork.get(4);
    if (max_index < 0) return code::bad_max_index;
    options.max_index = static_cast<int>(std::min<std::int64_t>(max_index, std::numeric_limits<int>::max()));
  }
  if (is_first_call) return check_lengths(arguments, options);
  return is_readable && arguments.lrw >= last_real_input ? code::ok : code::bad_info;
}

int read_limits(const Arguments& arguments, bool is_first_call, Options& options) {
  if (arguments.flag(7)) {
    options.max_step = arguments.rwork(2);
    if (!is_positive(options.max_step)) return code::bad_max_step;
  }
  if (arguments.flag(14) || !is_first_call) {
    options.max_steps = arguments.iwork.get(20);
    if (options.max_steps <= 0) return code::bad_max_steps;
  }
  if (arguments.flag(4)) options.stop_time = arguments.rwork(1);
  options.has_initial_step = arguments.flag(8);
  if (options.has_initial_step) options.initial_step = arguments.rwork(3);
  return code::ok;
}

int read_stepping(const Arguments& arguments, bool is_first_call, Options& options) {
  core::StepOptions& stepping = options.stepping;
  stepping.max_order = options.max_order;
  stepping.min_stages = stepping.max_stages = 3;
  stepping.classical_control = arguments.flag(15);
  if (arguments.flag(16) || !is_first_call) {
    stepping.safety = arguments.rwork(11);
    stepping.fastest_fall = arguments.rwork(12);
    stepping.fastest_rise = arguments.rwork(13);
    if (!std::isgreater(stepping.safety, 0.001) || !std::isless(stepping.safety, 1.0)) return code::bad_safety;
    if (!std::isgreaterequal(stepping.fastest_fall, 1.0) || !std::islessequal(stepping.fastest_rise, 1.0) ||
        std::isless(stepping.fastest_rise, 0.0))
      return code::bad_ratios;
  }
  if (arguments.flag(17) || !is_first_call) {
    stepping.keep_from = arguments.rwork(14);
    stepping.keep_to = arguments.rwork(15);
    if (!std::islessequal(stepping.keep_from, 1.0) || !std::isgreaterequal(stepping.keep_to, 1.0))
      return code::bad_quotients;
  }
  return code::ok;
}

int check_tolerances(const Arguments& arguments) {
  const int count = arguments.flag(2) ? arguments.n : 1;
  const auto is_zero = [](double tolerance) { return tolerance == 0.0; };
  if (!std::all_of(arguments.rtol, arguments.rtol + count, is_tolerance)) return code::bad_rtol;
  if (!std::all_of(arguments.atol, arguments.atol + count, is_tolerance)) return code::bad_atol;
  const bool all_zero = std::all_of(arguments.rtol, arguments.rtol + count, is_zero) &&
                        std::all_of(arguments.atol, arguments.atol + count, is_zero);
  return all_zero ? code::no_tolerance : code::ok;
}

bool are_finite(double a, double b) { return std::isfinite(a) && std::isfinite(b); }

// Those that its documents ask for.
Lengths dgelda_lengths(const Arguments& arguments, const Options& options) {
  const double n = arguments.n, max_index = options.max_index, q = max_index + 1.0;
  const std::int64_t size = arguments.n;
  if (arguments.method == bdf_method)
    return {50.0 + (21.0 + options.max_order + 14.0 * max_index) * n + (6.0 + max_index + 6.0 * q * q) * n * n,
            20 + 2 * size};
  return {20.0 + (29.0 + 14.0 * max_index) * n + (15.0 + max_index + 6.0 * q * q) * n * n, 20 + 6 * size};
}

// The state and no more: see call_state.h and the archives of what it consists of.
Lengths sfndae_lengths(const Arguments& arguments, const Options& options) {
  const double m = arguments.m, n = arguments.n;
  return {100.0 + 2.0 * options.max_index + m + (20.0 + 2.0 * options.max_order + 4.0 * options.max_index) * n,
          shortest_iwork};
}

Lengths sfmdae_lengths(const Arguments& arguments, const Options& options) {
  return {100.0 + (24.0 + 2.0 * options.max_order) * arguments.n, shortest_iwork};
}

}  // namespace

// The last digit of a state word is the version of the layout.
const Routine dgelda_routine{5'304'461, 4, true, false, dgelda_lengths};
const Routine sfndae_routine{5'304'471, max_cval, false, true, sfndae_lengths};
const Routine sfndaf_routine{5'304'491, max_cval, false, true, sfndae_lengths};
const Routine sfmdae_routine{5'304'481, max_cval, false, false, sfmdae_lengths};

int read_options(const Arguments& arguments, bool is_first_call, Options& options) {
  for (int k = 2; k <= num_info && is_first_call; ++k)
    if (arguments.info[k] != 0 && arguments.info[k] != 1) return code::bad_info;
  if (arguments.flag(5) && !arguments.routine->knows_constants) return code::bad_info;
  if (arguments.n <= 0 || arguments.n > largest_order) return code::bad_order;
  if (arguments.m <= 0 || arguments.m > largest_order) return code::bad_equations;
  int result = read_sizes(arguments, is_first_call, options);
  if (result == code::ok) result = read_limits(arguments, is_first_call, options);
  if (result == code::ok) result = read_stepping(arguments, is_first_call, options);
  if (result != code::ok) return result;
  if (arguments.method != bdf_method && arguments.method != radau_method) return code::bad_method;
  return check_tolerances(arguments);
}

void store_options(const Arguments& arguments, const Options& options) {
  arguments.iwork.set(3, options.max_order);
  arguments.iwork.set(4, options.max_index);
  arguments.iwork.set(20, options.max_steps);
  const core::StepOptions& stepping = options.stepping;
  const double values[] = {stepping.safety, stepping.fastest_fall, stepping.fastest_rise, stepping.keep_from,
                           stepping.keep_to};
  for (int i = 0; i < 5; ++i) arguments.rwork(11 + i) = values[i];
}

int check_start(const Arguments& arguments, const Options& options, double t, const double* x) {
  const double tout = arguments.tout;
  if (tout == t) return code::tout_is_t;
  if (!are_finite(t, tout) || std::fabs(tout - t) < smallest_step(t, tout)) return code::tout_too_close;
  for (int i = 0; i < arguments.n; ++i)
    if (arguments.weight(i, x[i]) <= 0.0) return code::zero_weight;
  const double direction = tout < t ? -1.0 : 1.0;
  if (options.has_initial_step) {
    if (std::isless(options.initial_step * direction, 0.0)) return code::wrong_direction;
    if (!std::isgreater(std::fabs(options.initial_step), 0.0)) return code::zero_first_step;
  }
  if (!options.stop_time) return code::ok;
  if (!std::isfinite(*options.stop_time) || (*options.stop_time - t) * direction < 0.0) return code::stop_behind;
  return (*options.stop_time - tout) * direction < 0.0 ? code::stop_before_tout : code::ok;
}

int check_continuation(const Arguments& arguments, const Options& options, double t, double t_internal,
                       double direction) {
  const double tout = arguments.tout;
  if (tout == t) return code::tout_is_t;
  if (!are_finite(t, tout)) return code::tout_too_close;
  if (options.stop_time) {
    if (!std::isfinite(*options.stop_time) || (*options.stop_time - t_internal) * direction < 0.0)
      return code::stop_behind;
    if ((*options.stop_time - tout) * direction < 0.0) return code::stop_before_tout;
  }
  return (tout - t) * direction < 0.0 ? code::wrong_direction : code::ok;
}

core::IntegrationOptions integration_options(const Arguments& arguments, const Options& options) {
  core::IntegrationOptions result;
  const std::size_t n = core::index(arguments.n);
  std::vector<double> rtol(n), atol(n);
  for (int i = 0; i < arguments.n; ++i) {
    rtol[core::index(i)] = arguments.rtol_of(i);
    atol[core::index(i)] = arguments.atol_of(i);
  }
  result.tolerances = {std::move(rtol), std::move(atol)};
  result.method = arguments.method == radau_method ? core::Method::radau : core::Method::bdf;
  result.never_pass_output = arguments.method == radau_method;
  result.stepping = options.stepping;
  result.short_checkpoints = true;
  result.max_step = options.max_step;
  result.stop_time = options.stop_time;
  result.max_steps = static_cast<long>(std::min<std::int64_t>(options.max_steps, std::numeric_limits<long>::max()));
  return result;
}

}  // namespace sfdae::f77
