// What a call of DGELDA or SFNDAE writes to its arguments.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/call_outputs.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sfdae::f77 {

namespace {

// Positions of outputs in IWORK
constexpr int next_order = 7, last_order = 8, steps_before = 10, steps = 11, evaluations = 12, factorizations = 13,
              error_failures = 14, other_failures = 15, array_rank = 19;
// and in RWORK.
constexpr int next_step = 3, t_internal = 4, last_step = 7, roundoff = 9;

}  // namespace

void clear_outputs(const Arguments& arguments, const Options& options, double t) {
  for (int position :
       {next_order, last_order, steps_before, steps, evaluations, factorizations, error_failures, other_failures})
    arguments.iwork.set(position, 0);
  if (!options.has_initial_step) arguments.rwork(next_step) = 0.0;
  arguments.rwork(t_internal) = t;
  arguments.rwork(last_step) = 0.0;
  arguments.rwork(roundoff) = std::numeric_limits<double>::epsilon();
}

void publish_characteristics(const Arguments& arguments, const core::CharacteristicValues& values) {
  const int all[max_cval] = {values.mu, values.d, values.a, values.u, values.v};
  for (int i = 0; i < arguments.routine->num_cval; ++i) arguments.cval.set(i + 1, all[i]);
}

void publish_point(const Arguments& arguments, const core::IndexAnalysis& analysis, double t,
                   const std::vector<double>& x, const std::vector<double>& xdot) {
  publish_characteristics(arguments, analysis.values);
  arguments.iwork.set(array_rank, (analysis.values.mu + 1) * arguments.m - analysis.values.a - analysis.v_hat);
  *arguments.t = t;
  std::copy(x.begin(), x.end(), arguments.x);
  std::copy(xdot.begin(), xdot.end(), arguments.xprime);
}

void publish_steps_before(const Arguments& arguments, long count) { arguments.iwork.set(steps_before, count); }

void publish_counts(const Arguments& arguments, const core::Integration& integration, long points) {
  const core::StepState state = integration.stepper().state();
  const core::IntegrationCounts counts = integration.counts();
  const IntegerArray& iwork = arguments.iwork;
  iwork.set(next_order, state.next_order);
  iwork.set(last_order, state.last.order);
  iwork.set(steps, counts.steps);
  iwork.set(evaluations, iwork.get(evaluations) + points);
  iwork.set(factorizations, counts.factorizations);
  iwork.set(error_failures, counts.error_failures);
  iwork.set(other_failures, counts.other_failures);
  arguments.rwork(next_step) = state.next_step;
  arguments.rwork(last_step) = state.last.h;
  arguments.rwork(t_internal) = state.t;
}

bool has_zero_weight(const Arguments& arguments, const double* x) {
  for (int i = 0; i < arguments.n; ++i)
    if (arguments.weight(i, x[i]) <= 0.0) return true;
  return false;
}

void enlarge_tolerances(const Arguments& arguments, const double* x) {
  double squares = 0.0, largest = 0.0;
  for (int i = 0; i < arguments.n; ++i) {
    const double weight = arguments.weight(i, x[i]), ratio = weight > 0.0 ? std::fabs(x[i]) / weight : 0.0;
    squares += ratio * ratio;
    largest = std::max(largest, ratio);
  }
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const double norm = std::sqrt(squares / arguments.n);
  // The test of the core is that of the largest component with half of eps.
  const double factor = 100.0 * eps * std::max(norm, 0.5 * (1.0 + 4.0 * eps) * largest);
  const int count = arguments.flag(2) ? arguments.n : 1;
  for (int i = 0; i < count; ++i) {
    arguments.rtol[i] *= factor;
    arguments.atol[i] *= factor;
  }
}

}  // namespace sfdae::f77
