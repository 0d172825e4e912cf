// Derivatives of maps along a direction, by finite differences with automatic step selection.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>
#include <vector>

namespace sfdae::core {

// values(s, to) writes values(s), one number per size.
using MapAlong = std::function<void(double s, std::vector<double>& to)>;

struct DerivativeAlong {
  std::vector<double> value;
  double step = 0.0;
  double error = std::numeric_limits<double>::infinity();  // relative
  bool is_there() const;
};

// Settings. sizes: of the values. step: initial step of s. least: derivatives below it, in sizes, count as 0.
struct Differencing {
  const std::vector<double>& sizes;
  double step;
  double least = 0.0;
  // Values at 0, shared by several directions: empty until first computed. Null: there is only one direction.
  std::vector<double>* here = nullptr;
};

// d/ds values(s) at 0, of fourth order. Steps become smaller if two orders disagree or values do not exist, and larger
// if rounding errors dominate. Throws the last Failure of the map if there are no values for any step.
DerivativeAlong differentiate_along(const MapAlong& values, const Differencing& how);

}  // namespace sfdae::core
