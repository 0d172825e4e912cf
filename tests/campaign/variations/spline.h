// Interpolating splines of degree 1, and of degree 3 with the not-a-knot condition. Constants are not continued: the
// outermost polynomials hold beyond the data.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace campaign {

struct Spline {
  int degree = 3;
  std::vector<double> x, y;
  std::vector<std::array<double, 4>> pieces;  // coefficients of powers of (u - x[i])

  // The coefficients of powers of (u - x[i]) where u lies, and that x[i]; at a knot those after it.
  const std::array<double, 4>& piece(double u, double& origin) const;
  // The derivative of that order at u.
  double derivative(double u, int order) const;
};

Spline make_spline(int degree, std::vector<double> x, std::vector<double> y);

}  // namespace campaign
