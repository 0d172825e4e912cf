// Derivatives of maps along a direction, by differences whose steps are found.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>
#include <vector>

namespace sfdae::core {

// values(s, to) writes values(s), as many numbers as there are sizes.
using MapAlong = std::function<void(double s, std::vector<double>& to)>;

struct DerivativeAlong {
  std::vector<double> value;
  double step = 0.0;
  double error = std::numeric_limits<double>::infinity();  // relative
  bool is_there() const;
};

// How a map is asked. sizes: of its values. step: of s, tried first. least: derivatives below that, in sizes, are as
// good as 0.
struct Differencing {
  const std::vector<double>& sizes;
  double step;
  double least = 0.0;
  // Values at 0, which several directions have in common: empty until one of them has asked. Null: there is one
  // direction only.
  std::vector<double>* here = nullptr;
};

// d/ds values(s) at 0, of fourth order. Steps become smaller where two orders disagree and where there are no values,
// larger where rounding errors are what is left. Throws the last Failure of the map where there are no values for any.
DerivativeAlong differentiate_along(const MapAlong& values, const Differencing& how);

}  // namespace sfdae::core
