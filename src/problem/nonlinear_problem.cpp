// A nonlinear problem along a jet.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/nonlinear_problem.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "linalg/matrix.h"
#include "linalg/rank.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

void multiply_all(double factor, double* values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) values[i] *= factor;
}

}  // namespace

Trouble NonlinearProblem::stopped(double t) const {
  Trouble trouble;
  if (stop_is_requested()) trouble.status = SFDAE_STOPPED;
  trouble.t = t;
  return trouble;
}

Trouble NonlinearProblem::evaluate_prescribed(double t, double* values) {
  Trouble trouble;
  if (inputs_.components.empty()) return trouble;
  const std::size_t count = inputs_.components.size();
  std::fill_n(values, count, 0.0);
  trouble.function = "prescribed_values";
  trouble.t = t;
  trouble.code = inputs_.values(t, 0, values, inputs_.user);
  if (trouble.code != 0) trouble.status = trouble.code < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED;
  else if (!all_finite(values, count)) trouble.status = SFDAE_NOT_FINITE;
  return trouble;
}

Trouble NonlinearProblem::residuals(double t, const double* jet, int order, double* F) {
  Trouble trouble = stopped(t);
  if (trouble.status != SFDAE_OK) return trouble;
  ++evaluations_;
  trouble = evaluate_values(t, jet, order, F);
  if (differentiations_.empty()) return trouble;
  for (int i = 0; i < m_; ++i)
    for (int k = differentiations_[index(i)] + 1; k <= order; ++k) F[i + k * m_] = 0.0;
  return trouble;
}

Trouble NonlinearProblem::linearize(double t, const double* jet, Orders orders, const Scaling& scaling,
                                    TaylorData& data) {
  Trouble trouble = stopped(t);
  if (trouble.status != SFDAE_OK) return trouble;
  ++linearizations_;
  data.resize(m_, n_, orders);
  data.differentiations = differentiations_;
  if (scaling.once_more)
    for (int& count : data.differentiations) ++count;
  data.t = t;
  trouble = evaluate_gradients(t, jet, orders, data);
  if (trouble.status != SFDAE_OK) return trouble;
  trouble = drop_rounding_errors(t, jet, orders, data);
  if (trouble.status != SFDAE_OK) return trouble;
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
  if (scaling.columns != nullptr && !scaling.columns->empty()) data.scale_columns(*scaling.columns);
  if (!data.scale(scaling.time_scale, scaling.rows, scaling.preferred_rows)) {
    trouble.status = SFDAE_NOT_FINITE;
    trouble.row = -1;
  }
  return trouble;
}

// F_x' far below F_x is suspected to be a sum of terms that cancel, a multiple of a constraint for example: then it changes
// by about its size when the jet does by a few roundings, and the unit of time must not follow it.
Trouble NonlinearProblem::drop_rounding_errors(double t, const double* jet, Orders orders, TaylorData& data) {
  constexpr double suspicious = 1e-10, few = 32.0, moving = 0.01;
  constexpr int samples = 2;
  data.E0_was_rounding = false;
  if (orders.E < 0 || orders.A < 0) return {};
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
      moved[i] = jet[i] * (1.0 + few * unit_roundoff * (2e-9 * static_cast<double>(generator() % 1000000001u) - 1.0));
    const Trouble trouble = evaluate_gradients(t, moved.data(), {0, 0, -1}, nearby);
    if (trouble.status != SFDAE_OK) return trouble;
    for (std::size_t i = 0; i < area; ++i)
      change = std::max(change, std::fabs(nearby.E(0).data[i] - data.E(0).data[i]));
  }
  data.E0_was_rounding = change > moving * size;
  if (data.E0_was_rounding) std::fill_n(data.E(0).data, area, 0.0);
  return {};
}

Trouble RecordedProblem::failure(double t) const {
  Trouble trouble;
  trouble.status = SFDAE_NOT_FINITE;
  trouble.t = t;
  trouble.row = evaluator_.failure().equation;
  trouble.detail =
      "the equations cannot be evaluated" + format(" at t = %.15g: ", t) + evaluator_.failure().message + ".";
  return trouble;
}

Trouble RecordedProblem::evaluate_values(double t, const double* jet, int order, double* F) {
  return evaluator_.values(t, jet, order, F) ? Trouble() : failure(t);
}

Trouble RecordedProblem::evaluate_gradients(double t, const double* jet, Orders orders, TaylorData& data) {
  const SeriesOrders wanted{orders.f, orders.E, orders.A};
  double* E = orders.E >= 0 ? data.E(0).data : nullptr;
  double* A = orders.A >= 0 ? data.A(0).data : nullptr;
  double* F = orders.f >= 0 ? data.f(0) : nullptr;
  return evaluator_.gradients(t, jet, wanted, F, E, A, &data.differentiations) ? Trouble() : failure(t);
}

void CallbackProblem::to_derivatives(const double* jet, int order) {
  const std::size_t size = index(n());
  derivatives_.resize(size * index(order + 1));
  double factorial = 1.0;
  for (int k = 0; k <= order; ++k) {
    factorial *= std::max(k, 1);
    for (std::size_t i = 0; i < size; ++i) derivatives_[size * index(k) + i] = factorial * jet[size * index(k) + i];
  }
}

Trouble CallbackProblem::call(double t, int order, const double* derivatives, double* F, double* F_x,
                              double* F_xdot) {
  const std::size_t m_size = index(m()), area = m_size * index(n());
  std::fill_n(F, m_size, 0.0);
  if (F_x != nullptr) std::fill_n(F_x, area, 0.0);
  if (F_xdot != nullptr) std::fill_n(F_xdot, area, 0.0);
  Trouble trouble;
  trouble.function = "F";
  trouble.order = order;
  trouble.t = t;
  trouble.code = function_(t, order, derivatives, F, F_x, F_xdot, user_);
  if (trouble.code != 0) {
    trouble.status = trouble.code < 0                            ? SFDAE_CALLBACK_STOPPED
                     : trouble.code == SFDAE_ORDER_NOT_AVAILABLE ? SFDAE_ORDER_MISSING
                                                                 : SFDAE_CALLBACK_FAILED;
    return trouble;
  }
  const auto check = [&](const char* name, const double* values, std::size_t count) {
    if (values == nullptr || trouble.status != SFDAE_OK || all_finite(values, count)) return;
    trouble.status = SFDAE_NOT_FINITE;
    trouble.function = name;
    int first = 0;
    while (all_finite(values + first, 1)) ++first;
    trouble.row = first % m();
    trouble.column = first / m();
  };
  check("F", F, m_size);
  check("F_x", F_x, area);
  check("F_xdot", F_xdot, area);
  return trouble;
}

Trouble CallbackProblem::evaluate_values(double t, const double* jet, int order, double* F) {
  to_derivatives(jet, order + 1);
  double factorial = 1.0;
  for (int k = 0; k <= order; ++k) {
    factorial *= std::max(k, 1);
    double* F_k = F + index(m()) * index(k);
    const Trouble trouble = call(t, k, derivatives_.data(), F_k, nullptr, nullptr);
    if (trouble.status != SFDAE_OK) return trouble;
    for (int i = 0; i < m(); ++i) F_k[i] /= factorial;
  }
  return {};
}

Trouble CallbackProblem::evaluate_gradients(double t, const double* jet, Orders orders, TaylorData& data) {
  const int highest = std::max({orders.E, orders.A, orders.f});
  to_derivatives(jet, highest + 1);
  unused_.resize(index(m()));
  double factorial = 1.0;
  for (int k = 0; k <= highest; ++k) {
    factorial *= std::max(k, 1);
    double* F = k <= orders.f ? data.f(k) : unused_.data();
    double* A = k <= orders.A ? data.A(k).data : nullptr;
    double* E = k <= orders.E ? data.E(k).data : nullptr;
    const Trouble trouble = call(t, k, derivatives_.data(), F, A, E);
    if (trouble.status != SFDAE_OK) return trouble;
    const std::size_t area = index(m()) * index(n());
    multiply_all(1.0 / factorial, F, index(m()));
    if (A != nullptr) multiply_all(1.0 / factorial, A, area);
    if (E != nullptr) multiply_all(1.0 / factorial, E, area);
  }
  return {};
}

}  // namespace sfdae::core
