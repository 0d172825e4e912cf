// Finite differences of maps along a direction.
// SPDX-License-Identifier: BSD-3-Clause
#include "hybrid/map_differences.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Relative error that is accurate enough, and relative error beyond which there is no derivative. Steps differ by a
// factor of ten; the counts limit them in either direction.
constexpr double good = 1e-8, useless = 1e-3, factor = 0.1;
constexpr int most_smaller = 4, most_larger = 5;
// Rounding errors of maps relative to the sizes: some units of jumps, which are iterated to machine precision.
constexpr double noise = 3e-15;
// Smaller differences are ignored in the test for kinks.
constexpr double rounding = 1e-11;

// Evaluates the map; throws Failure if values are not finite.
void find_finite_values(const MapAlong& values, double s, Vector& to) {
  values(s, to);
  if (!all_finite(to.data(), to.size()))
    throw Failure(SFDAE_NOT_FINITE,
                  "near a transition, where it is differentiated, values after it, or its function, are not finite.");
}

// Central differences do not see a kink at 0: there the one-sided slopes differ by an amount that does not shrink with
// the step, and the derivative does not exist. Differences of the size of rounding errors are ignored. above, below:
// values at the step of the derivative. here: values at 0, empty if not known yet.
void find_kink(const MapAlong& values, const Differencing& how, Vector above, Vector below,
               DerivativeAlong& derivative) {
  constexpr double much_smaller = 1e-2, still_there = 0.1;
  const Vector& sizes = how.sizes;
  const std::size_t n = sizes.size();
  Vector own_here;
  Vector& here = how.here != nullptr ? *how.here : own_here;
  if (how.here == nullptr || here.empty()) {
    Vector found(n);
    find_finite_values(values, 0.0, found);
    here = std::move(found);
  }
  double before = 0.0;
  for (double step : {derivative.step, much_smaller * derivative.step}) {
    const bool is_known = step == derivative.step;
    if (!is_known) {
      find_finite_values(values, step, above);
      find_finite_values(values, -step, below);
    }
    double difference = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      difference = std::max(difference, std::fabs(above[i] + below[i] - 2.0 * here[i]) / sizes[i]);
    // The difference due to a kink shrinks with the step, too.
    if (difference <= rounding) break;
    const bool is_kink = !is_known && difference / step > still_there * before;
    if (is_kink) derivative.error = std::numeric_limits<double>::infinity();
    before = difference / step;
  }
}

class Differences {
 public:
  Differences(const MapAlong& values, const Differencing& how) : values_(values), how_(how) {}

  // True if further steps on this side of the first one may be better than the best so far.
  bool may_improve() const { return best.error > good; }
  bool is_rounded() const { return is_rounded_; }
  // Tries another step; true if it is better than those before, or has no values. Callbacks that stop end the search.
  bool try_step(double step) {
    const double places[] = {1.0, -1.0, 2.0, -2.0};
    try {
      for (int k = 0; k < 4; ++k) {
        at_[k].resize(how_.sizes.size());
        find_finite_values(values_, places[k] * step, at_[k]);
      }
    } catch (const Failure& reason) {
      const bool may_be_nearer = reason.status() == SFDAE_NOT_FINITE || reason.status() == SFDAE_NO_CONSISTENT_VALUES;
      if (!may_be_nearer) throw;
      failure = reason;
      is_rounded_ = false;
      return true;
    }
    DerivativeAlong found = difference(step);
    if (!(found.error < best.error)) return false;
    best = std::move(found);
    above = at_[0];
    below = at_[1];
    return true;
  }

  DerivativeAlong best;
  Vector above, below;             // of the best step
  std::optional<Failure> failure;  // the last one

 private:
  // The error is that of second order, which is larger, plus a bound on rounding errors.
  DerivativeAlong difference(double step) {
    const std::size_t n = how_.sizes.size();
    DerivativeAlong found{Vector(n), step, 0.0};
    double size = how_.least, error = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double near = (at_[0][i] - at_[1][i]) / (2.0 * step), far = (at_[2][i] - at_[3][i]) / (4.0 * step);
      found.value[i] = (4.0 * near - far) / 3.0;
      size = std::max(size, std::fabs(found.value[i]) / how_.sizes[i]);
      error = std::max(error, std::fabs(found.value[i] - near) / how_.sizes[i]);
    }
    const double rounded = noise / step;
    is_rounded_ = error < 10.0 * rounded;
    found.error = size > 0.0 ? (error + rounded) / size : 0.0;
    return found;
  }

  const MapAlong& values_;
  const Differencing& how_;
  Vector at_[4];
  bool is_rounded_ = false;
};

}  // namespace

bool DerivativeAlong::is_there() const { return error <= useless; }

DerivativeAlong differentiate_along(const MapAlong& values, const Differencing& how) {
  Differences differences(values, how);
  differences.try_step(how.step);
  const bool larger_first = differences.is_rounded();
  for (bool larger : {larger_first, !larger_first}) {
    // Skip larger steps if smaller ones have no values.
    if (larger && differences.failure) break;
    bool goes_on = true;
    double step = how.step;
    for (int k = 1; k < (larger ? most_larger : most_smaller); ++k) {
      if (!goes_on || !differences.may_improve()) break;
      step = larger ? step / factor : step * factor;
      goes_on = differences.try_step(step);
      if (larger && differences.failure) break;
    }
  }
  DerivativeAlong derivative = std::move(differences.best);
  if (derivative.value.empty() && differences.failure) throw std::move(*differences.failure);
  // An overflow leaves no derivative to test.
  if (!derivative.value.empty())
    find_kink(values, how, std::move(differences.above), std::move(differences.below), derivative);
  return derivative;
}

}  // namespace sfdae::core
