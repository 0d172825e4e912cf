// A nonlinear problem along a jet.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/nonlinear_problem.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "linalg/random.h"
#include "linalg/rank.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Coefficients of F, a column for each order; counts may be empty.
template <class Value>
void clear_rows_left_out(const std::vector<int>& counts, int order, Value* F) {
  const int m = static_cast<int>(counts.size());
  for (int i = 0; i < m; ++i)
    for (int k = counts[index(i)] + 1; k <= order; ++k) F[i + k * m] = Value();
}

}  // namespace

CallbackError NonlinearProblem::stopped(double t) const {
  CallbackError error;
  if (stop_is_requested()) error.status = SFDAE_STOPPED;
  error.t = t;
  error.user_t = user_t();
  return error;
}

CallbackError NonlinearProblem::evaluate_prescribed(double t, double* values) {
  CallbackError error;
  if (inputs_.components.empty()) return error;
  const std::size_t count = inputs_.components.size();
  std::fill_n(values, count, 0.0);
  error.function = "prescribed_values";
  error.t = t;
  error.user_t = user_t();
  error.code = inputs_.values(t, 0, values, inputs_.user);
  if (error.code != 0) error.status = error.code < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED;
  else if (!all_finite(values, count)) error.status = SFDAE_NOT_FINITE;
  return error;
}

void NonlinearProblem::follow_structure(bool follows) {
  const Structure* const known = follows ? structure() : nullptr;
  if (known != nullptr) proposed_ = known->offsets.c;
  follows_structure_ = known != nullptr;
}

CallbackError NonlinearProblem::residuals(double t, const double* jet, int order, double* F) {
  CallbackError error = stopped(t);
  if (error.status != SFDAE_OK) return error;
  ++evaluations_;
  error = evaluate_values(t, jet, order, F);
  clear_rows_left_out(differentiations(), order, F);
  return error;
}

bool NonlinearProblem::residuals_side_by_side(int count, const LaneBlock* t, const LaneBlock* jets, int order,
                                              LaneBlock* F) {
  if (stop_is_requested() || !evaluate_lanes(t, jets, order, F)) return false;
  evaluations_ += count;
  clear_rows_left_out(differentiations(), order, F);
  return true;
}

CallbackError NonlinearProblem::linearize(double t, const double* jet, Orders orders, const Scaling& scaling,
                                          TaylorData& data) {
  CallbackError error = stopped(t);
  if (error.status != SFDAE_OK) return error;
  ++linearizations_;
  data.resize(m_, n_, orders);
  data.differentiations = differentiations();
  if (scaling.once_more)
    for (int& count : data.differentiations) ++count;
  data.t = t;
  error = evaluate_gradients(t, jet, orders, data);
  if (error.status != SFDAE_OK) return error;
  error = drop_rounding_errors(t, jet, orders, data);
  if (error.status != SFDAE_OK) return error;
  data.clear_unused_rows();
  // TaylorData scales plain derivatives.
  const std::size_t area = index(m_) * index(n_);
  double factorial = 1.0;
  for (int k = 0; k <= std::max({orders.E, orders.A, orders.f}); ++k) {
    factorial *= std::max(k, 1);
    if (k <= orders.E && k > 1) multiply_all(factorial, data.E(k).data, area);
    if (k <= orders.A) multiply_all(-factorial, data.A(k).data, area);
    if (k <= orders.f) multiply_all(-factorial, data.f(k), index(m_));
  }
  if (scaling.units != nullptr && !scaling.units->are_one()) data.scale_columns(*scaling.units);
  if (!data.scale(scaling.time_scale, scaling.rows, scaling.preferred_rows)) {
    error.status = SFDAE_NOT_FINITE;
    error.row = -1;
  }
  return error;
}

// If F_x' is far below F_x, it may be a sum of terms that cancel, a multiple of a constraint for example. Then it
// changes by about its size when the jet does by a few rounding errors, and the unit of time must ignore it.
CallbackError NonlinearProblem::drop_rounding_errors(double t, const double* jet, Orders orders, TaylorData& data) {
  // docs/design/rank_decisions.md. These values are chosen without recorded figures: a sum that cancelled to 1e-10,
  // changes by a hundredth of its size under 32 rounding errors, in one of two samples. A sum of terms of order one
  // leaves 1e-16, far below the first, and moves by more than the last.
  constexpr double suspicious = 1e-10, few = 32.0, moving = 0.01;
  constexpr int samples = 2;
  data.E0_was_rounding = false;
  // Finite differences choose increments against rounding errors.
  if (orders.E < 0 || orders.A < 0 || data.difference_noise.A > 0.0) return {};
  const std::size_t area = index(m_) * index(n_);
  const double size = max_abs(data.E(0).data, static_cast<int>(area));
  if (size == 0.0 || size > suspicious * max_abs(data.A(0).data, static_cast<int>(area))) return {};
  const std::size_t length = index(n_) * index(std::max({orders.E, orders.A, orders.f}) + 2);
  std::vector<double> moved(length);
  TaylorData nearby;
  nearby.resize(m_, n_, {0, 0, -1});
  std::minstd_rand generator(1);
  double change = 0.0;
  for (int sample = 0; sample < samples; ++sample) {
    for (std::size_t i = 0; i < length; ++i)
      moved[i] = jet[i] * (1.0 + few * unit_roundoff * symmetric_random(generator));
    const CallbackError error = evaluate_gradients(t, moved.data(), {0, 0, -1}, nearby);
    if (error.status != SFDAE_OK) return error;
    for (std::size_t i = 0; i < area; ++i)
      change = std::max(change, std::fabs(nearby.E(0).data[i] - data.E(0).data[i]));
  }
  data.E0_was_rounding = change > moving * size;
  if (data.E0_was_rounding) std::fill_n(data.E(0).data, area, 0.0);
  return {};
}

CallbackError RecordedProblem::failure(double t) const {
  ++failed_evaluations_;
  if (source_) return source_->error();
  CallbackError error;
  error.status = status_of(evaluator_.failure());
  error.t = t;
  error.user_t = user_t();
  error.row = evaluator_.failure().equation;
  error.detail = "the equations cannot be evaluated at " + error.where() + ": " + evaluator_.failure().message + ".";
  return error;
}

long RecordedProblem::constant_matrices() {
  const Record& record = evaluator_.record();
  if (!has_constant_matrices_)
    has_constant_matrices_ = source_ == nullptr && record.is_constant_E() && record.is_constant_A();
  return *has_constant_matrices_ ? evaluator_.changes_of_parameters() : -1;
}

const Structure* RecordedProblem::structure() {
  const Record& record = evaluator_.record();
  if (!structure_is_known_ && record.m() == record.n() && record.n() <= Signature::most_unknowns) {
    const Signature signature(record);
    const Transversal transversal = highest_transversal(signature);
    if (transversal.exists()) structure_ = std::make_shared<const Structure>(signature, transversal);
  }
  structure_is_known_ = true;
  return structure_.get();
}

CallbackError RecordedProblem::gradient_entries(double t, const double* jet, int order,
                                                const std::vector<int>& limits, double* values) {
  return gradients_for(t,
                       [&](TaylorEvaluator& evaluator) { return evaluator.entries(t, jet, order, limits, values); });
}

CallbackError RecordedProblem::gradient_entries(double t, const double* jet, VaryingEntries& varying,
                                                double* values) {
  return gradients_for(t, [&](TaylorEvaluator& evaluator) { return evaluator.entries(t, jet, varying, values); });
}

const LaneBlock* RecordedProblem::gradient_entries_side_by_side(int count, const LaneBlock* t, const LaneBlock* jets,
                                                                int order, const std::vector<int>& limits) {
  if (!has_lanes(order) || stop_is_requested()) return nullptr;
  if (!lanes_.evaluate_entries(evaluator_, LaneEvaluator::points_of(t, jets, order, n()), order, limits)) {
    ++failed_evaluations_;
    return nullptr;
  }
  linearizations_ += count;
  return lanes_.gradients();
}

CallbackError RecordedProblem::residuals_within(double t, const double* jet,
                                                const std::shared_ptr<const OrderLimits>& limits, int more,
                                                double* F) {
  CallbackError error = stopped(t);
  if (error.status != SFDAE_OK) return error;
  ++evaluations_;
  return evaluator_.values_within(t, jet, limits, more, F) ? error : failure(t);
}

CallbackError RecordedProblem::gradient_entries_within(double t, const double* jet,
                                                       const std::shared_ptr<const OrderLimits>& limits,
                                                       double* values) {
  return gradients_for(t,
                       [&](TaylorEvaluator& evaluator) { return evaluator.entries_within(t, jet, limits, values); });
}

const LaneEvaluator* RecordedProblem::evaluate_within(int count, const LaneEvaluator::Points& points,
                                                      const std::shared_ptr<const OrderLimits>& limits,
                                                      bool with_gradients) {
  if (!has_lanes(limits->highest) || stop_is_requested()) return nullptr;
  if (!lanes_.evaluate_within(evaluator_, points, limits, with_gradients)) {
    ++failed_evaluations_;
    return nullptr;
  }
  (with_gradients ? linearizations_ : evaluations_) += count;
  return &lanes_;
}

CallbackError RecordedProblem::evaluate_values(double t, const double* jet, int order, double* F) {
  return evaluator_.values(t, jet, order, F, &differentiations()) ? CallbackError() : failure(t);
}

bool RecordedProblem::evaluate_lanes(const LaneBlock* t, const LaneBlock* jets, int order, LaneBlock* F) {
  if (source_) return false;
  if (!lanes_.evaluate(evaluator_, LaneEvaluator::points_of(t, jets, order, n()), order, false)) {
    ++failed_evaluations_;
    return false;
  }
  for (int i = 0; i < m(); ++i)
    for (int k = 0; k <= order; ++k) F[i + k * m()] = lanes_.value(i)[k];
  return true;
}

CallbackError RecordedProblem::evaluate_gradients(double t, const double* jet, Orders orders, TaylorData& data) {
  const SeriesOrders wanted{orders.f, orders.E, orders.A};
  double* E = orders.E >= 0 ? data.E(0).data : nullptr;
  double* A = orders.A >= 0 ? data.A(0).data : nullptr;
  double* F = orders.f >= 0 ? data.f(0) : nullptr;
  return evaluator_.gradients(t, jet, wanted, F, E, A, &data.differentiations) ? CallbackError() : failure(t);
}

}  // namespace sfdae::core
