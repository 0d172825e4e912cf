// Tolerances and the weighted norm of the error test.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/error_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/index.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

// A tolerance must exceed 100 unit roundoffs, as in DASSL.
constexpr double rounding_safety = 100.0;
// Stands for 1 / 0, so that any error is too large but nothing overflows.
constexpr double no_tolerance = 1e200;
// Smaller relative speeds count as zero: times to change would overflow.
constexpr double standstill = 1e-300;

// Turns NaN into an error that no tolerance allows; std::max would drop it, and the step would be accepted.
double worst_if_unknown(double error) { return std::isnan(error) ? no_tolerance : error; }

}  // namespace

double ErrorWeights::reduction(double tol) const {
  return safety_ * (tightening_ == Tightening::none ? 1.0 : std::min(1.0, 4.0 * std::pow(tol, 1.0 / 6.0)));
}

void ErrorWeights::set(const Tolerances& tolerances, Tightening tightening, double safety) {
  ErrorWeights set;
  set.tightening_ = tightening;
  set.safety_ = safety;
  set.floor_ = floor_;
  set.ceiling_ = ceiling_;
  set.part_ = part_;
  set.floor_ratio_ = floor_ratio_;
  set.rtol_ = tolerances.rtol;
  set.atol_ = tolerances.atol;
  set.inverse_.assign(tolerances.rtol.size(), 1.0);
  set.reduction_ = tolerances.rtol.mapped([&set](double rtol) { return rtol > 0.0 ? set.reduction(rtol) : 1.0; });
  if (tightening == Tightening::none)
    for (std::size_t i = 0; i < tolerances.rtol.size(); ++i) set.relative_.push_back(tolerances.rtol[i]);
  *this = std::move(set);
}

void ErrorWeights::update(const double* x) {
  floor_ratio_ = 0.0;
  for (std::size_t i = 0; i < rtol_.size(); ++i) {
    const double size = std::fabs(x[i]);
    // Without rtol the tolerance is relative to the component itself.
    const double factor = rtol_[i] > 0.0 ? reduction_[i] : reduction(atol_[i] / std::max(size, atol_[i]));
    double weight = part_ * factor * (rtol_[i] * size + atol_[i]);
    if (ceiling_ != nullptr) weight = std::min(weight, std::max(ceiling_[i], rounding_safety * unit_roundoff * size));
    if (floor_ != nullptr && floor_[i] > 0.0) {
      floor_ratio_ = weight > 1.0 / no_tolerance ? std::max(floor_ratio_, floor_[i] / weight) : no_tolerance;
      weight = std::max(weight, floor_[i]);
    }
    inverse_[i] = weight > 1.0 / no_tolerance ? 1.0 / weight : no_tolerance;
  }
}

void ErrorWeights::update(const double* x, const double* scale) {
  update(x);
  relative_.resize(rtol_.size());
  for (int i = 0; i < static_cast<int>(rtol_.size()); ++i) relative_[index(i)] = relative_tolerance(i, scale[i]);
}

double ErrorWeights::relative_tolerance(int i, double size) const {
  const double atol = atol_[index(i)];
  return atol > 0.0 ? std::max(rtol_[index(i)], atol / std::max(std::fabs(size), atol)) : rtol_[index(i)];
}

double ErrorWeights::norm(const double* e) const {
  double largest = 0.0;
  for (std::size_t i = 0; i < inverse_.size(); ++i)
    largest = std::max(largest, worst_if_unknown(std::fabs(e[i]) * inverse_[i]));
  return largest;
}

double ErrorWeights::norm(const double* e, double exponent) const {
  double largest = 0.0;
  for (std::size_t i = 0; i < inverse_.size(); ++i) {
    const double error = worst_if_unknown(std::fabs(e[i]) * inverse_[i]);
    // Most components are far below the largest, and the power is expensive.
    if (!(error > largest)) continue;
    const double relative = relative_.empty() ? rtol_[i] : relative_[i];
    largest = std::max(largest, error * std::pow(std::min(relative, 1.0), 1.0 - exponent));
  }
  return largest;
}

double ErrorWeights::first_step(const double* x, const double* xdot, double exponent) const {
  double h = std::numeric_limits<double>::infinity();
  for (int i = 0; i < static_cast<int>(rtol_.size()); ++i) {
    const double allowed = tolerance(i, x), speed = std::fabs(xdot[i]);
    const double size = rtol_[index(i)] > 0.0 ? allowed / rtol_[index(i)] : std::max(std::fabs(x[i]), allowed);
    // The half is a margin (docs/design/error_control.md).
    if (speed > standstill * size && allowed > 0.0)
      h = std::min(h, 0.5 * std::pow(allowed / size, exponent) * size / speed);
  }
  return h;
}

double ErrorWeights::tightest(const double* x) const {
  double smallest = 1.0;
  for (int i = 0; i < static_cast<int>(rtol_.size()); ++i) {
    const double tol = relative_tolerance(i, x[i]);
    if (tol > 0.0) smallest = std::min(smallest, tol);
  }
  return smallest;
}

int ErrorWeights::worst(const double* e) const {
  int result = 0;
  for (int i = 1; i < static_cast<int>(inverse_.size()); ++i)
    if (std::fabs(e[i]) * inverse_[index(i)] > std::fabs(e[result]) * inverse_[index(result)]) result = i;
  return result;
}

double ErrorWeights::rounding(const double* x) const {
  double largest = 0.0;
  for (int i = 0; i < static_cast<int>(rtol_.size()); ++i) {
    const double allowed = tolerance(i, x);
    if (allowed > 0.0) largest = std::max(largest, rounding_safety * unit_roundoff * std::fabs(x[i]) / allowed);
  }
  return largest;
}

double ErrorWeights::tolerance(int i, const double* x) const {
  return rtol_[index(i)] * std::fabs(x[i]) + atol_[index(i)];
}

}  // namespace sfdae::core
