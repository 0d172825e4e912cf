// The discrete adjoint of an integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/discrete_adjoint.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Weights of points that steps yet to be read depend on.
constexpr std::size_t window = max_bdf_order + 1;

std::size_t bytes_of(const KeptPoint& point) {
  return sizeof(KeptPoint) + sizeof(double) * (point.jet.x.capacity() + point.xdot.capacity());
}

bool is_zero(ConstView a) {
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i)
      if (a(i, j) != 0.0) return false;
  return true;
}

}  // namespace

DiscreteAdjoint::DiscreteAdjoint(std::unique_ptr<AdjointSystem> system, std::vector<double> S)
    : system_(std::move(system)), S_(std::move(S)), xdot_(index(system_->unknowns())) {}

// ---- Forward ---------------------------------------------------------------------------------------------------

void DiscreteAdjoint::make_room() {
  // Nothing fails in commit().
  if (steps_.size() == steps_.capacity()) steps_.reserve(2 * steps_.size() + 64);
  if (kept_.capacity() - kept_.size() < index(max_stages)) kept_.reserve(2 * kept_.size() + 64);
}

void DiscreteAdjoint::start(const Integrator& integrator) {
  make_room();
  Step step;
  step.t = integrator.stepper->state().t;
  step.first_kept = kept_.size();
  if (!steps_.empty()) {
    kept_.push_back(system_->point(nullptr));
    bytes_ += bytes_of(kept_.back());
  }
  bytes_ += sizeof(Step);
  origin_ = steps_.size();
  steps_.push_back(step);
}

// The slope at t of Lagrange's polynomials over t and the newest points.
DiscreteAdjoint::Step DiscreteAdjoint::step_to(const TriedStep& tried) const {
  Step step;
  step.t = tried.t;
  step.h = tried.h;
  step.method = tried.method;
  step.first_kept = kept_.size();
  if (tried.method != nullptr) return step;
  step.order = tried.order;
  const std::size_t last = steps_.size() - 1;
  if (index(step.order) > steps_.size() - origin_)
    throw Failure(SFDAE_INTERNAL, format("a step of order %d with a history of %zu points at t = %.15g.", step.order,
                                         steps_.size() - origin_, step.t));
  const auto time = [&](int i) { return steps_[last - index(i)].t; };
  for (int i = 0; i < step.order; ++i) {
    step.c += 1.0 / (step.t - time(i));
    double slope = 1.0 / (time(i) - step.t);
    for (int j = 0; j < step.order; ++j)
      if (j != i) slope *= (step.t - time(j)) / (time(i) - time(j));
    step.rest[index(i)] = slope;
  }
  return step;
}

StepOutcome DiscreteAdjoint::attempt(Integrator& integrator, const Tolerances&) {
  Stepper& stepper = *integrator.stepper;
  const TriedStep tried = stepper.tried();
  try {
    make_room();
    tried_ = step_to(tried);
    tried_points_.clear();
    const int points = tried.method != nullptr ? tried.method->s : 1;
    for (int i = 0; i < points; ++i) {
      discretized_slope(tried, i, xdot_);
      tried_points_.push_back(tried.method != nullptr ? system_->stage(*tried.method, i, xdot_.data())
                                                      : system_->point(xdot_.data()));
    }
  } catch (...) {
    stepper.withdraw();
    stepper.set_next_step(tried.h);
    throw;
  }
  return StepOutcome::accepted;
}

void DiscreteAdjoint::commit(Integrator&) {
  steps_.push_back(tried_);
  bytes_ += sizeof(Step);
  for (KeptPoint& point : tried_points_) {
    bytes_ += bytes_of(point);
    kept_.push_back(std::move(point));
  }
}

// ---- Backward --------------------------------------------------------------------------------------------------

std::optional<std::size_t> DiscreteAdjoint::point_at(double t) const {
  for (std::size_t k = steps_.size(); k-- > 0;)
    if (steps_[k].t == t) return k;
  return std::nullopt;
}

double DiscreteAdjoint::nearest_time(double t) const {
  double nearest = steps_.front().t;
  for (const Step& step : steps_)
    if (std::fabs(step.t - t) < std::fabs(nearest - t)) nearest = step.t;
  return nearest;
}

// Weights of point k become those of the points before it.
void DiscreteAdjoint::read_back(std::size_t k, std::vector<Matrix>& weights, View gradient) {
  const Step& step = steps_[k];
  const View here = weights[k % window];
  const KeptPoint* const points = kept_.data() + step.first_kept;
  PointStatus status;
  if (step.method != nullptr) status = system_->step_back(*step.method, step.h, points, {here, gradient});
  else if (step.order > 0) status = system_->step_back(*points, step.c, {here, gradient});
  else status = system_->restore_back(*points, {here, gradient});
  if (status == PointStatus::callback_error) system_->callback_error().raise();
  if (status != PointStatus::ok)
    throw Failure(SFDAE_SINGULAR, format("the equations of the sensitivities at t = %.15g are singular: the "
                                         "characteristic values that are known do not hold there.",
                                         step.t));
  for (int i = 0; i < std::max(step.order, 1); ++i) {
    const View before = weights[(k - 1 - index(i)) % window];
    const double part = step.order > 0 ? step.rest[index(i)] : 1.0;
    for (int q = 0; q < here.cols; ++q)
      for (int r = 0; r < here.rows; ++r) before(r, q) += part * here(r, q);
  }
  fill(here, 0.0);
}

void DiscreteAdjoint::gradient(const Functionals& functionals, const std::function<void(double)>& move_to,
                               double* gradient) {
  const int n = unknowns();
  const std::size_t size = index(n), points = functionals.points.size();
  std::vector<Matrix> weights(window, Matrix(n, functionals.count));
  Matrix sum(std::max(count(), 1), functionals.count);
  const View result = sum.view().top(count());
  for (std::size_t k = steps_.size(); k-- > 0;) {
    const View here = weights[k % window];
    for (std::size_t point = 0; point < points; ++point)
      for (int q = 0; q < functionals.count && functionals.points[point] == k; ++q)
        for (int i = 0; i < n; ++i) here(i, q) += functionals.weights[index(i) + size * (point + points * index(q))];
    if (k == 0) break;
    // Later steps say nothing about earlier points.
    if (is_zero(here)) continue;
    move_to(steps_[k - 1].t);
    read_back(k, weights, result);
  }
  const ConstView start{S_.data(), n, count(), std::max(n, 1)};
  multiply(1.0, Op::transposed, start, Op::plain, weights[0], 1.0, result);
  for (int q = 0; q < functionals.count; ++q) {
    if (!all_finite(result.column(q), index(count())))
      throw Failure(SFDAE_NOT_FINITE, "the gradient overflows: rescale the problem or the weights.");
  }
  for (int q = 0; q < functionals.count; ++q)
    std::copy_n(result.column(q), count(), gradient + static_cast<std::ptrdiff_t>(q) * count());
}

}  // namespace sfdae::core
