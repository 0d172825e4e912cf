// The largest change of values that were to stay as given.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/value_change.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"

namespace sfdae::core {

ValueChange largest_change(const double* given, const double* changes, const std::vector<double>& tolerances,
                           int count) {
  ValueChange largest;
  for (int i = 0; i < count; ++i) {
    const double size = std::fabs(changes[i]);
    if (size == 0.0) continue;
    const double tolerance = tolerances[index(i)];
    const double ratio = tolerance > 0.0 ? size / tolerance : std::numeric_limits<double>::max();
    if (ratio > largest.in_tolerances) largest = {i, given[i], given[i] + changes[i], ratio, false};
  }
  return largest;
}

namespace {

// Relative to the largest entry of a row of [E A]: smaller ones are rounding errors of the user's arithmetic. (Chosen.)
constexpr double few = 1e-10;

// Entries of row i of E that are larger are nonzero.
double largest_zero(const TaylorData& data, int i) {
  const ConstView E = data.E(0), A = data.A(0);
  double size = 0.0;
  for (int j = 0; j < data.n; ++j) size = std::max({size, std::fabs(E(i, j)), std::fabs(A(i, j))});
  return few * size;
}

}  // namespace

void mark_differentiated(const TaylorData& data, char* flags) {
  const ConstView E = data.E(0);
  for (int i = 0; i < data.m; ++i) {
    const double zero = largest_zero(data, i);
    for (int j = 0; j < data.n; ++j)
      if (std::fabs(E(i, j)) > zero) flags[j] = 1;
  }
}

double differentiated_change(const TaylorData& data, const Units& units, const double* dx, const double* tolerances) {
  const ConstView E = data.E(0);
  double largest = 0.0;
  for (int i = 0; i < data.m; ++i) {
    const double zero = largest_zero(data, i);
    double entries = 0.0, change = 0.0, tolerance = 0.0;
    for (int j = 0; j < data.n; ++j) {
      const double entry = E(i, j) / units[j];
      entries = std::max(entries, std::fabs(E(i, j)));
      change += entry * dx[j];
      tolerance += std::fabs(entry) * tolerances[j];
    }
    if (entries > zero && tolerance > 0.0) largest = std::max(largest, std::fabs(change) / tolerance);
  }
  return largest;
}

}  // namespace sfdae::core
