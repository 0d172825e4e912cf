// Steps of BDF.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/bdf.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "integrate/algebraic_course.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Maximum of the first attempt relative to the interval: not a simple fraction, which might be a period of the data
// (docs/design/error_control.md). Its digits are those of the root of cos x = x.
constexpr double first_bdf_step_fraction = 0.7390851e-3;
// Error allowed for the polynomial for x within a step, in units of the weights of linear and of nonlinear problems:
// these are the tolerances times a factor below one, and a fifth of that (docs/design/error_control.md).
constexpr double bdf_interpolation_error = 5.0, nonlinear_bdf_interpolation_error = 25.0;
// Larger errors, in units of the tolerance, are not used for step-size control.
constexpr double largest_error = 1e100;

}  // namespace

// The first attempt measures the error of order 1, which then corrects the step size: a change of x by about the square
// root of the tolerance has an error of about the tolerance.
double Bdf::first_step(const ErrorWeights& weights, const double* x, const double* xdot, double span) {
  return std::min(first_bdf_step_fraction * span, weights.first_step(x, xdot, 0.5));
}

void Bdf::set_options(const StepOptions& options) {
  max_order_ = options.max_order;
  control_.set_max_order(max_order_);
}

// Adapts the sizes to the history.
void Bdf::resize(const StrangenessFreeSystem& system) {
  const std::size_t n = history_.size_x(), size_w = history_.size_w();
  tried_.resize(n, size_w, system.undetermined() > 0);
  estimate_.resize(n, size_w, system.maps_errors_in_place());
  const std::size_t columns = system.is_linear() ? 0 : index(system.taylor_order() + 1);
  guess_.assign_zero(n * columns);
  is_linear_ = system.is_linear();
  needs_x_ = system.undetermined() > 0 || !is_linear_;
}

void Bdf::start(const StrangenessFreeSystem& system, const StartingPoint& point, double h) {
  Bdf started = *this;
  started.history_.start(point);
  started.resize(system);
  started.control_.start(max_order_);
  started.next_step_ = h;
  started.last_ = {};
  started.forget_interpolation();
  *this = std::move(started);
}

StepState Bdf::state() const {
  return {history_.time(0),
          tried_.t,
          last_,
          next_step_,
          control_.order(),
          control_.failures_in_a_row(),
          std::numeric_limits<double>::infinity(),
          true,
          judged_.error,
          0};
}

void Bdf::archive(Archive& archive, const StrangenessFreeSystem& system) {
  // Only the points that the highest order needs are stored.
  const BdfHistory::Sizes sizes{index(system.unknowns()), index(system.leading_size())};
  const int points = history_.archive_size(archive, sizes, max_order_ + 3, last_.order);
  if (archive.is_reading()) resize(system);
  control_.archive(archive);
  if (archive.is_reading() && (control_.order() >= points || last_.order >= points)) throw DamagedArchive();
  for (double* value : {&next_step_, &last_.h, &last_.leading_coefficient}) archive.real(*value);
  history_.archive_points(archive, points);
  forget_interpolation();
}

// Degree of the predictor of x. Without differential equations no error estimate selects the order, and the degree is
// as high as the points of a checkpoint allow.
int Bdf::degree_of_guess(const StrangenessFreeSystem& system) const {
  if (system.differential() > 0) return std::min(tried_.order, history_.points() - 1);
  return std::min({history_.points(), max_order_ + 3, max_course_points}) - 1;
}

// Initial guess for nonlinear systems: the predictor of the step.
Guess Bdf::guess(const StrangenessFreeSystem& system, ErrorWeights& weights) {
  if (system.is_linear()) return {};
  // The iteration uses the tolerances at the last point, whatever was tried since.
  weights.update(history_.x().data());
  const auto polynomial = history_.polynomial_x(degree_of_guess(system));
  guess_.forget_ends();
  polynomial.taylor(tried_.t, system.taylor_order(), guess_.here.data());
  polynomial.taylor(history_.time(0), system.taylor_order(), guess_.before.data());
  return {guess_.here.data(), guess_.before.data(), weights.inverse()};
}

StepOutcome Bdf::attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) {
  control_before_ = control_;
  has_differences_ = false;
  tried_.t = t;
  tried_.h = t - history_.time(0);
  const PointStatus status = system.move_to(t);
  if (const auto failure = failed_outcome(status)) return *failure;

  if (history_.is_at_start()) history_.place_fictitious_point(tried_.h);
  control_.limit_order(history_.points());
  tried_.order = control_.order();
  const bool follows_course = !is_linear_ && system.differential() == 0;
  const int differences = std::max(tried_.order + 3, follows_course ? degree_of_guess(system) + 1 : 0);
  history_.compute_differences(std::min(history_.points(), differences), needs_x_);
  tried_.set_formula(history_, system.is_constant(), system.undetermined() > 0);
  const Guess start = guess(system, weights);
  const PointStatus solved =
      system.solve({tried_.c, tried_.w_rest.data(), tried_.x_rest.data(), start}, tried_.x.data());
  if (const auto failure = failed_outcome(solved)) return *failure;
  if (!all_finite(tried_.x.data(), tried_.x.size())) return StepOutcome::not_finite;

  system.leading(tried_.x.data(), tried_.w.data());
  weights.update(tried_.x.data());
  const double deviation = follows_course ? course_of_tried(start.taylor, degree_of_guess(system) + 1, weights) : 0.0;
  if (deviation > 1.0 && control_.failures_in_a_row() < most_course_refusals) {
    next_step_ = control_.failed(tried_.h);
    return StepOutcome::error_too_large;
  }
  judged_.may_rise = control_.may_raise_order();
  judged_.error = estimate_.estimate(system, history_, {tried_, judged_.may_rise}, weights, judged_.terms);
  const StepOutcome outcome = judge(judged_.terms, judged_.error);
  if (follows_course && outcome == StepOutcome::accepted)
    next_step_ = course_growth(deviation, degree_of_guess(system)) * tried_.h;
  return outcome;
}

PointsOfCurve Bdf::points_of_tried() const {
  PointsOfCurve points;
  points.add(history_.time(0), history_.x().data());
  points.add(tried_.t, tried_.x.data());
  for (int i = 1; i < std::min(tried_.order + 1, history_.points()); ++i)
    points.add(history_.time(i), history_.x_at(i).data());
  return points;
}

double Bdf::course_of_tried(const double* predicted, int points, const ErrorWeights& weights) const {
  TriedCourse course{{}, points, predicted, tried_.x};
  for (int i = 0; i < course.count; ++i) course.past[index(i)] = &history_.x_at(i);
  return course_deviation(course, weights);
}

StepOutcome Bdf::test_beside(const LocalTerms& terms, double error) {
  LocalTerms larger = judged_.terms;
  for (int q = 0; q <= max_bdf_order + 1; ++q) larger.of_order[q] = std::max(larger.of_order[q], terms.of_order[q]);
  control_ = control_before_;
  control_.limit_order(history_.points());
  return judge(larger, std::max(judged_.error, error));
}

StepOutcome Bdf::judge(const LocalTerms& terms, double error) {
  if (error <= 1.0) {
    next_step_ = control_.accepted(tried_.h, terms);
    return StepOutcome::accepted;
  }
  next_step_ = control_.rejected(tried_.h, terms, error < largest_error);
  return StepOutcome::error_too_large;
}

void Bdf::commit() {
  history_.append(tried_.t, tried_.w, tried_.x);
  last_ = {tried_.h, tried_.order, tried_.c};
  forget_interpolation();
}

void Bdf::prepare_interpolation() {
  // Least distance of the fictitious point of a straight line, relative to t: nearer, rounding errors make its slope.
  static const double far_enough = std::sqrt(std::numeric_limits<double>::epsilon());
  if (has_differences_) return;
  if (history_.is_at_start() && last_.order == 0) {
    const double least = far_enough * std::fabs(history_.time(0));
    history_.place_fictitious_point(std::copysign(std::max(std::fabs(next_step_), least), next_step_));
  }
  history_.compute_differences(std::min(degree_within() + 2, history_.points()), true);
  // Before the first step the fictitious point depends on the next step size.
  has_differences_ = last_.order > 0;
}

void Bdf::interpolate(const PointValues& point) {
  prepare_interpolation();
  const int degree = degree_within();
  if (point.w != nullptr) history_.polynomial_w(degree).evaluate(point.t, point.w, nullptr);
  history_.polynomial_x(degree).evaluate(point.t, point.x, point.xdot);
}

// The error is the next divided difference's: algebraic components may vary faster than w, which controls the steps.
bool Bdf::interpolates_x(ErrorWeights& weights) {
  const int degree = degree_within();
  if (!interpolates_x_ && last_.order > 0 && history_.points() > degree + 1) {
    prepare_interpolation();
    // Maximum of |prod (t - t_i)| within the step.
    double largest_product = 0.25 * last_.h * last_.h;
    for (int i = 2; i <= degree; ++i) largest_product *= std::fabs(history_.time(0) - history_.time(i));
    weights.update(history_.x().data());
    const double error = largest_product * weights.norm(history_.difference_x(degree + 1).data());
    interpolates_x_ = error <= (is_linear_ ? bdf_interpolation_error : nonlinear_bdf_interpolation_error);
  }
  return interpolates_x_.value_or(false);
}

Guess Bdf::guess_within(double t, int order) {
  if (last_.order == 0) return {};
  prepare_interpolation();
  return guess_.within(history_.polynomial_x(degree_within()), {t, history_.time(0), history_.time(1)}, order);
}

}  // namespace sfdae::core
