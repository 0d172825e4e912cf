// Points that a polynomial x(t) goes through.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace sfdae::core {

struct PointsOfCurve {
  static constexpr std::size_t most = 8;
  std::size_t count = 0;
  std::array<double, most> t{};
  std::array<const double*, most> x{};

  void add(double time, const double* values) {
    t[count] = time;
    x[count++] = values;
  }
  // Derivative of x' at the first point with respect to x at the second one, times their distance.
  double part_of_second_in_slope() const {
    double part = 1.0;
    for (std::size_t k = 2; k < count; ++k) part *= (t[0] - t[k]) / (t[1] - t[k]);
    return part;
  }
  // x and x' there, of n components.
  void evaluate(double time, std::size_t n, double* value, double* slope) const {
    std::fill_n(value, n, 0.0);
    std::fill_n(slope, n, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
      // Lagrange's polynomial of point i, and its derivative.
      double weight = 1.0, rate = 0.0;
      for (std::size_t k = 0; k < count; ++k) {
        if (k == i) continue;
        const double per_gap = 1.0 / (t[i] - t[k]);
        rate = rate * (time - t[k]) * per_gap + weight * per_gap;
        weight *= (time - t[k]) * per_gap;
      }
      for (std::size_t j = 0; j < n; ++j) {
        value[j] += weight * x[i][j];
        slope[j] += rate * x[i][j];
      }
    }
  }
};

}  // namespace sfdae::core
