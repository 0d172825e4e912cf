// Units of the unknowns in which a problem is analyzed first.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/usual_units.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Columns below smallest_column are left alone: they may be rounding errors.
constexpr double moderate_column_ratio = 1024.0, smallest_column = 1e-12;

}  // namespace

TaylorData data_in_units(CoefficientSource& source, double t, const Units& units, double time_scale) {
  source.set_units(units);
  TaylorData data;
  const CallbackError error = source.evaluate(t, {0, 0, -1}, time_scale, data);
  if (error.status != SFDAE_OK) error.raise();
  return data;
}

Units usual_units(CoefficientSource& source, double t) {
  const std::size_t n = index(source.n());
  std::vector<double> scale(n, 1.0);
  bool needed = false;
  // Scaling of rows and columns depends on each other: two sweeps.
  for (int sweep = 0; sweep < 2; ++sweep) {
    const TaylorData data = data_in_units(source, t, scale);
    std::vector<double> size(n);
    double largest = 0.0, smallest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < n; ++j) {
      const int column = static_cast<int>(j);
      size[j] = std::max(max_abs(data.E(0).column(column), data.m), max_abs(data.A(0).column(column), data.m));
      largest = std::max(largest, size[j]);
      if (size[j] > 0.0) smallest = std::min(smallest, size[j]);
    }
    needed = needed || largest > moderate_column_ratio * smallest;
    for (std::size_t j = 0; j < n; ++j)
      if (size[j] > smallest_column * largest) scale[j] *= std::ldexp(1.0, -std::ilogb(size[j]));
  }
  return needed ? Units(scale) : Units();
}

}  // namespace sfdae::core
