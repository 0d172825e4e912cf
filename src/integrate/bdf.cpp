// Backward differentiation formulas with variable step.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/bdf.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "integrate/newton_polynomial.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// alpha_k = 1 + 1/2 + ... + 1/k, the leading coefficient of BDF k for equal steps.
constexpr double alpha[max_bdf_order + 1] = {0.0, 1.0, 1.5, 11.0 / 6.0, 25.0 / 12.0, 137.0 / 60.0};

// differences[i] := divided difference of values[0..i] over times[0..i].
template <std::size_t N>
void divided_differences(const std::array<double, N>& times, const std::array<Vector, N>& values, int count,
                         std::array<Vector, N>& differences) {
  const std::size_t size = values[0].size();
  for (int i = 0; i < count; ++i) std::copy_n(values[index(i)].data(), size, differences[index(i)].data());
  for (int j = 1; j < count; ++j)
    for (int i = count - 1; i >= j; --i) {
      const double per_gap = 1.0 / (times[index(i - j)] - times[index(i)]);
      double* __restrict to = differences[index(i)].data();
      const double* __restrict newer = differences[index(i - 1)].data();
      for (std::size_t r = 0; r < size; ++r) to[r] = (newer[r] - to[r]) * per_gap;
    }
}

// The polynomial and its derivative (slope may be null).
template <std::size_t N>
void evaluate_polynomial(const std::array<double, N>& times, const std::array<Vector, N>& differences, int degree,
                         double t, double* value, double* slope) {
  const std::size_t size = differences[0].size();
  std::copy_n(differences[index(degree)].data(), size, value);
  if (slope != nullptr) std::fill_n(slope, size, 0.0);
  for (int i = degree - 1; i >= 0; --i) {
    const double gap = t - times[index(i)];
    const double* __restrict d = differences[index(i)].data();
    if (slope != nullptr)
      for (std::size_t r = 0; r < size; ++r) slope[r] = slope[r] * gap + value[r];
    for (std::size_t r = 0; r < size; ++r) value[r] = value[r] * gap + d[r];
  }
}

// Taylor coefficients of a guess.
std::size_t guess_columns(const StrangenessFreeSystem& system) {
  return system.is_linear() ? 0 : index(system.taylor_order() + 1);
}

// The first attempt in units of the interval, at most: no simple fraction, which might be a period of the data.
constexpr double first_step_fraction = 0.7390851e-3;

}  // namespace

// The first attempt measures the error of order 1, and its size is corrected from that: a change of x by about the
// square root of the tolerance has an error of about the tolerance.
double Bdf::first_step(const ErrorWeights& weights, const double* x, const double* xdot, double span) {
  return std::min(first_step_fraction * span, weights.first_step(x, xdot, 0.5));
}

void Bdf::set_options(const StepOptions& options) {
  max_order_ = options.max_order;
  control_.set_max_order(max_order_);
}

void Bdf::resize(std::size_t n, std::size_t size_w) {
  for (int i = 0; i < capacity; ++i) {
    w_[index(i)].resize(size_w);
    dw_[index(i)].resize(size_w);
    x_[index(i)].resize(n);
    dx_[index(i)].resize(n);
  }
  for (Vector* v : {&tried_x_, &x_rest_, &error_, &mapped_}) v->assign(n, 0.0);
  for (Vector* v : {&tried_w_, &w_rest_, &predicted_, &difference_}) v->assign(std::max(n, size_w), 0.0);
  differences_.assign(4 * size_w, 0.0);
  mapped_differences_.assign(4 * n, 0.0);
}

void Bdf::start(StrangenessFreeSystem& system, const StartingPoint& point, double h) {
  resize(point.x.size(), point.w.size());
  for (Vector* v : {&guess_, &guess_before_}) v->assign(point.x.size() * guess_columns(system), 0.0);
  needs_x_ = system.undetermined() > 0 || !system.is_linear();
  times_[0] = point.t;
  w_[0] = point.w;
  x_[0] = point.x;
  slope_w_ = point.wdot;
  slope_x_ = point.xdot;
  points_ = 2;
  fictitious_ = true;
  control_.start(max_order_);
  next_step_ = h;
  last_order_ = 0;
  last_step_ = 0.0;
  leading_coefficient_ = std::numeric_limits<double>::infinity();
}

void Bdf::archive(Archive& archive, const StrangenessFreeSystem& system) {
  const std::size_t n = index(system.unknowns()), size_w = index(system.leading_size());
  // More points than the highest order needs are not kept.
  int points = std::min(points_, max_order_ + 3);
  archive.small(points, fictitious_, last_order_);
  if (archive.is_reading()) {
    if (points < 2 || points > capacity || last_order_ < 0 || last_order_ > max_bdf_order) throw DamagedArchive();
    points_ = points;
    resize(n, size_w);
    for (Vector* v : {&guess_, &guess_before_}) v->assign(n * guess_columns(system), 0.0);
    needs_x_ = system.undetermined() > 0 || !system.is_linear();
  }
  control_.archive(archive);
  for (double* value : {&next_step_, &last_step_, &leading_coefficient_}) archive.real(*value);
  archive.reals(times_.data(), index(points));
  // Before the first step the second point is fictitious, and its values follow from the slopes.
  const bool has_slope = points == 2 && fictitious_;
  for (int i = 0; i < (has_slope ? 1 : points); ++i) {
    archive.reals(w_[index(i)], size_w);
    archive.reals(x_[index(i)], n);
  }
  if (has_slope) {
    archive.reals(slope_w_, size_w);
    archive.reals(slope_x_, n);
  }
}

// A point at t - h on the tangent: the predictor of the first step is the slope there.
void Bdf::place_fictitious_point(double h) {
  times_[1] = times_[0] - h;
  for (std::size_t i = 0; i < slope_w_.size(); ++i) w_[1][i] = w_[0][i] - h * slope_w_[i];
  for (std::size_t i = 0; i < slope_x_.size(); ++i) x_[1][i] = x_[0][i] - h * slope_x_[i];
}

void Bdf::compute_differences(int count) {
  divided_differences(times_, w_, count, dw_);
  if (needs_x_) divided_differences(times_, x_, count, dx_);
}

// The polynomial of the given degree through the last points.
Guess Bdf::guess(const StrangenessFreeSystem& system, int degree, ErrorWeights& weights) {
  if (system.is_linear()) return {};
  const int order = system.taylor_order();
  // Iterations are judged by the tolerances at the last point, whatever was tried since.
  weights.update(x_[0].data());
  const std::size_t n = x_[0].size();
  newton_taylor(dx_, times_, degree, tried_t_, order, n, guess_.data());
  newton_taylor(dx_, times_, degree, times_[0], order, n, guess_before_.data());
  return {guess_.data(), guess_before_.data(), weights.inverse()};
}

StepOutcome Bdf::attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) {
  const double h = t - times_[0];
  control_before_ = control_;
  tried_h_ = h;
  tried_t_ = t;
  const PointStatus status = system.move_to(tried_t_);
  if (const auto failure = failed_outcome(status)) return *failure;

  if (points_ == 2 && fictitious_) place_fictitious_point(h);
  control_.limit_order(points_);
  const int k = control_.order();
  tried_order_ = k;
  compute_differences(std::min(points_, k + 3));

  // D_h w = p'(t) + c (w - p(t)) with the predictor p through the newest points.
  const bool fixed_leading = system.is_constant() && points_ > k;
  const int degree = fixed_leading ? k : k - 1;
  double c = 0.0;
  if (fixed_leading) c = alpha[k] / h;
  else
    for (int i = 0; i < k; ++i) c += 1.0 / (tried_t_ - times_[index(i)]);
  tried_c_ = c;
  evaluate_polynomial(times_, dw_, degree, tried_t_, predicted_.data(), w_rest_.data());
  for (std::size_t i = 0; i < w_[0].size(); ++i) w_rest_[i] -= c * predicted_[i];
  if (needs_x_) {
    evaluate_polynomial(times_, dx_, degree, tried_t_, mapped_.data(), x_rest_.data());
    for (std::size_t i = 0; i < x_[0].size(); ++i) x_rest_[i] -= c * mapped_[i];
  }
  const Guess start = guess(system, std::min(k, points_ - 1), weights);
  const PointStatus solved = system.solve({c, w_rest_.data(), x_rest_.data(), start}, tried_x_.data());
  if (const auto failure = failed_outcome(solved)) return *failure;
  if (!all_finite(tried_x_.data(), x_[0].size())) return StepOutcome::not_finite;

  system.leading(tried_x_.data(), tried_w_.data());
  weights.update(tried_x_.data());
  const double error = estimate_errors(system, h, k, fixed_leading, weights, terms_);
  if (error <= 1.0) {
    next_step_ = control_.accepted(h, terms_);
    return StepOutcome::accepted;
  }
  next_step_ = control_.rejected(h, terms_, error < 1e100);
  return StepOutcome::error_too_large;
}

// The difference between w and its predictor of degree q is prod_{i<=q} (t - t_i) times a divided difference of
// order q + 1: from it the local terms of the orders around k, and the error of the formula.
double Bdf::estimate_errors(StrangenessFreeSystem& system, double h, int k, bool fixed_leading,
                            const ErrorWeights& weights, LocalTerms& terms) {
  std::fill(std::begin(terms.of_order), std::end(terms.of_order), -1.0);
  if (system.differential() == 0) {
    std::fill_n(error_.data(), error_.size(), 0.0);
    std::fill_n(terms.of_order, k + 1, 0.0);
    return 0.0;
  }
  const std::size_t size = w_[0].size(), n = x_[0].size();
  const int first = std::max(1, k - 2), last = std::min(k + 1, std::min(points_, k + 3) - 1);
  // Column q - first of differences_: w less its predictor of degree q.
  double factors[max_bdf_order + 2];
  std::copy_n(tried_w_.data(), size, difference_.data());
  double product = 1.0, factorial = 1.0;
  for (int q = 0; q <= last; ++q) {
    for (std::size_t i = 0; i < size; ++i) difference_[i] -= product * dw_[index(q)][i];
    product *= tried_t_ - times_[index(q)];
    factorial *= (q > 0 ? q : 1) * h;  // q! h^(q+1)
    factors[q] = factorial / product;
    if (q >= first) std::copy_n(difference_.data(), size, differences_.data() + size * index(q - first));
  }
  system.error_in_x(differences_.data(), last - first + 1, mapped_differences_.data());
  for (int q = first; q <= last; ++q)
    terms.of_order[q] = factors[q] * weights.norm(mapped_differences_.data() + n * index(q - first));
  std::copy_n(mapped_differences_.data() + n * index(k - first), n, error_.data());
  double constant = h / (tried_t_ - times_[index(k)]);
  if (fixed_leading) {
    double alpha0 = 0.0;
    for (int i = 0; i < k; ++i) alpha0 += h / (tried_t_ - times_[index(i)]);
    constant = std::max(constant, std::fabs(constant - alpha[k] + alpha0));
  }
  return constant * weights.norm(error_.data());
}

void Bdf::commit() {
  // The oldest vectors make room for the newest.
  const int count = std::min(points_ + 1, capacity);
  std::rotate(w_.begin(), w_.begin() + count - 1, w_.begin() + count);
  std::rotate(x_.begin(), x_.begin() + count - 1, x_.begin() + count);
  std::rotate(times_.begin(), times_.begin() + count - 1, times_.begin() + count);
  times_[0] = tried_t_;
  std::copy_n(tried_w_.data(), w_[0].size(), w_[0].data());
  std::copy_n(tried_x_.data(), x_[0].size(), x_[0].data());
  points_ = count;
  last_order_ = tried_order_;
  last_step_ = tried_h_;
  leading_coefficient_ = tried_c_;
}

void Bdf::interpolate(double t, double* w, double* x, double* xdot) {
  const int degree = std::min(std::max(last_order_, 1), points_ - 1);
  if (points_ == 2 && fictitious_ && last_order_ == 0) place_fictitious_point(next_step_);
  divided_differences(times_, w_, degree + 1, dw_);
  divided_differences(times_, x_, degree + 1, dx_);
  evaluate_polynomial(times_, dw_, degree, t, w, nullptr);
  evaluate_polynomial(times_, dx_, degree, t, x, xdot);
}

}  // namespace sfdae::core
