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

// Columns below smallest_column are not scaled: they may be rounding errors.
constexpr double moderate_column_ratio = 1024.0, smallest_column = 1e-12;

}  // namespace

TaylorData data_in_units(CoefficientSource& source, double t, const Units& units, double time_scale) {
  source.set_units(units);
  TaylorData data;
  const CallbackError error = source.evaluate(t, {0, 0, -1}, time_scale, data);
  if (error.status != SFDAE_OK) error.raise();
  return data;
}

namespace {

// The data in such units, with time and rows scaled again: all factors are powers of two. Throws Failure if products
// would overflow.
void change_units(const Units& units, TaylorData& data) {
  data.rescale_time(1.0 / data.time_scale);
  // The largest row determines the factors: the user's rows are used.
  for (View block : {data.E(0), data.A(0)})
    for (int j = 0; j < data.n; ++j)
      for (int i = 0; i < data.m; ++i) block(i, j) /= data.row_scale[index(i)];
  data.scale_columns(units);
  if (data.scale(0.0)) return;
  CallbackError error;
  error.status = SFDAE_NOT_FINITE;
  error.row = -1;
  error.t = data.t;
  error.raise();
}

}  // namespace

UsualUnits usual_units(CoefficientSource& source, double t) {
  const std::size_t n = index(source.n());
  UsualUnits result;
  result.data = data_in_units(source, t, {});
  TaylorData scaled;
  std::vector<double> scale(n, 1.0), size(n);
  bool needed = false;
  // Scalings of rows and columns depend on each other: two sweeps.
  for (int sweep = 0; sweep < 2; ++sweep) {
    if (sweep > 0) {
      scaled = result.data;
      change_units(scale, scaled);
    }
    const TaylorData& data = sweep > 0 ? scaled : result.data;
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
  if (!needed) return result;
  result.units = Units(scale);
  change_units(result.units, result.data);
  return result;
}

}  // namespace sfdae::core
