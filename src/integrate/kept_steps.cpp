// Stored steps for the adjoint of an integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/kept_steps.h"

#include <utility>

#include "integrate/companion.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

std::size_t bytes_of(const KeptPoint& point) {
  return sizeof(KeptPoint) + sizeof(double) * (point.jet.x.capacity() + point.xdot.capacity());
}

KeptPoint with_values_alone(const KeptPoint& point) {
  KeptPoint values;
  values.jet.t = point.jet.t;
  values.jet.n = point.jet.n;
  values.jet.x.assign(point.jet.column(0), point.jet.column(1));
  return values;
}

void KeptSteps::make_room() {
  if (steps_.size() == steps_.capacity()) steps_.reserve(2 * steps_.size() + 16);
  if (points_.capacity() - points_.size() < index(max_stages)) points_.reserve(2 * points_.size() + 16);
}

void KeptSteps::add(const KeptStep& step, std::vector<KeptPoint>& points) {
  steps_.push_back(step);
  steps_.back().first_kept = points_.size();
  bytes_ += sizeof(KeptStep);
  for (KeptPoint& point : points) {
    bytes_ += bytes_of(point);
    hash_.add(point.jet.x.data(), point.jet.x.size());
    points_.push_back(std::move(point));
  }
}

void KeptSteps::drop() {
  steps_ = {};
  points_ = {};
  bytes_ = 0;
}

// For BDF the slope at t of the Lagrange polynomials over t and the newest points.
KeptStep formula_of(const TriedStep& tried, const double* newest, std::size_t points) {
  KeptStep step;
  step.t = tried.t;
  step.h = tried.h;
  step.method = tried.method;
  if (tried.method != nullptr) return step;
  step.order = tried.order;
  if (index(step.order) > points)
    throw Failure(SFDAE_INTERNAL, format("a step of order %d with a history of %zu points at t = %.15g.", step.order,
                                         points, step.t));
  const auto time = [newest](int i) { return newest[-i]; };
  for (int i = 0; i < step.order; ++i) {
    step.c += 1.0 / (step.t - time(i));
    double slope = 1.0 / (time(i) - step.t);
    for (int j = 0; j < step.order; ++j)
      if (j != i) slope *= (step.t - time(j)) / (time(i) - time(j));
    step.rest[index(i)] = slope;
  }
  return step;
}

KeptStep interpolation_at(double t, int degree, const double* newest) {
  KeptStep step;
  step.t = t;
  step.order = degree;
  step.is_within = true;
  for (int i = 0; i <= degree; ++i) {
    double value = 1.0;
    for (int j = 0; j <= degree; ++j)
      if (j != i) value *= (t - newest[-j]) / (newest[-i] - newest[-j]);
    step.rest[index(i)] = value;
  }
  return step;
}

void keep_points(const PointKeeper& keeper, const TriedStep& tried, std::vector<double>& xdot,
                 std::vector<KeptPoint>& points) {
  points.clear();
  const int count = tried.method != nullptr ? tried.method->s : 1;
  for (int i = 0; i < count; ++i) {
    discretized_slope(tried, i, xdot);
    points.push_back(tried.method != nullptr ? keeper.stage(*tried.method, i, xdot.data())
                                             : keeper.point(xdot.data()));
  }
}

}  // namespace sfdae::core
